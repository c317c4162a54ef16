"""Errors near |B| = 0, and the worst ones of many regular states, against exact rational arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nullbody.bench.baseline import BASELINES
from nullbody.bench.exact import exact_null_space, orthogonality, residual, subspace_error
from nullbody.bench.matrix import three_prs_generic, three_prs_trigonometric
from nullbody.bench.numeric import BATCHES, Stacked
from nullbody.bench.own import kernels
from nullbody.bench.result import Accuracy, Worst
from nullbody.bench.robot import singular_height, state_near_singular
from nullbody.errors import NullbodyError
from nullbody.nullspace import null_space
from nullbody.typing import FloatArray

__all__ = ["DISTANCES", "accuracy", "worst"]

#: Distances of the states from |B| = 0 [m].
DISTANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0)

_FAILED = (np.linalg.LinAlgError, NullbodyError)


def accuracy() -> tuple[tuple[Accuracy, ...], dict[float, float]]:
    """All methods at all distances, and |B| there; A is the 3-PRS's, on its constraints and of full rank throughout."""
    robot = three_prs_trigonometric()
    height = singular_height(robot.numbers)
    stack = robot.numbers(np.array([state_near_singular(distance, height) for distance in DISTANCES]))
    exact = [exact_null_space(A) for A in stack]
    deltas = dict(zip(DISTANCES, map(float, np.linalg.det(stack[:, :, :9])), strict=True))
    found = [
        _measured(name, "ours", lambda A, method=method: method(A[None])[0], stack, exact)  # type: ignore[misc]
        for name, method in _own().items()
    ]
    found += [_measured(name, "baseline", entry.begin(), stack, exact) for name, entry in BASELINES.items()]
    return tuple(found), deltas


def worst(states: int, compared: int) -> tuple[Worst, ...]:
    """The largest errors of this package's ways, and of NumPy's, over random regular states."""
    robot = three_prs_trigonometric()
    values = robot.sample(np.random.default_rng(1), states)
    stack = robot.numbers(values)
    exact = [exact_null_space(A) for A in stack[:compared]]
    bases = {name: method(stack) for name, method in {**_own(), **BATCHES}.items()}
    for method in ("auto", "elimination"):
        fresh = three_prs_trigonometric()
        kernel = kernels({"N": (fresh, null_space(fresh.rows, fresh.independent, method=method).basis)})["N"]
        bases[f"nullbody compiled from the state, {method}"] = kernel.batch(values)[0]
    found = []
    for name, N in sorted(bases.items(), key=lambda entry: "nullbody" not in entry[0]):
        residuals = map(residual, stack, N)
        errors = [subspace_error(basis, known) for basis, known in zip(N, exact, strict=False)]
        found.append(Worst(name, max(residuals), states, max(errors), compared))
    return tuple(found)


def _own() -> dict[str, Stacked]:
    """This package's ways from the numbers of A to a basis, for a stack."""
    return {
        "nullbody compiled, N": _kernel("auto", "reduced"),
        "nullbody compiled, N~": _kernel("auto", "scaled"),
        "nullbody compiled, N by elimination": _kernel("elimination", "reduced"),
        "nullbody.null_space, columns it chooses": _array("reduced", "complete"),
        "nullbody.null_space, orthonormal": _array("orthonormal", "qr"),
    }


def _kernel(method: str, form: Any) -> Stacked:
    generic = three_prs_generic()
    kernel = kernels({"N": (generic, null_space(generic.rows, generic.independent, form, method).basis)})["N"]
    return lambda stack: kernel.batch(generic.values(stack))[0]


def _array(form: Any, method: str) -> Stacked:
    return lambda stack: np.asarray(null_space(stack, None, form, method).basis)


def _measured(
    name: str, kind: Any, method: Callable[[FloatArray], FloatArray], stack: FloatArray, exact: Sequence[FloatArray]
) -> Accuracy:
    errors, residuals, cosines = {}, {}, {}
    for distance, A, known in zip(DISTANCES, stack, exact, strict=True):
        try:
            N = method(A)
        except _FAILED:
            N = np.full(known.shape, np.nan)
        errors[distance] = subspace_error(N, known)
        residuals[distance] = residual(A, N)
        cosines[distance] = orthogonality(N)
    return Accuracy(name, kind, errors, residuals, cosines)
