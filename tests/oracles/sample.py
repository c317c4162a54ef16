"""Random admissible motions of the 3-PRS robot: values of all symbols, and what the second road says there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.equations import Equations, flat, shape
from nullbody.expr import Expr, Tape
from tests.oracles.robot import COORDINATES, PARAMETERS, robot

__all__ = ["INPUTS", "Quantities", "Sample", "all_outputs", "arranged", "evaluate", "sample"]

INPUTS = ("F1", "F2", "F3")
Quantities = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Sample:
    """One motion: `values` of q, q', q'', u and the parameters by name; `truth` by name of the output."""

    values: Mapping[str, float]
    truth: Quantities


def sample(seed: int) -> Sample:
    """A motion near an upright pose; the loops need not be closed, all equations hold for any q with A q' = 0.

    q'' and lambda solve [M A^T; A 0] (q''; lambda) = (S u - h; -c), in full coordinates.
    """
    rng = np.random.default_rng(seed)
    values = _parameters(rng) | dict(zip(COORDINATES, _pose(rng), strict=True))
    v, u = rng.uniform(-1, 1, 3), rng.uniform(-5, 5, 3)
    A = robot()(values | {f"{name}_dot": 0.0 for name in COORDINATES})["A"]
    N = np.vstack([-np.linalg.solve(A[:, :9], A[:, 9:]), np.eye(3)])
    values |= dict(zip((f"{name}_dot" for name in COORDINATES), N @ v, strict=True))
    truth = robot()(values)
    Q = np.concatenate([np.zeros(9), u])
    matrix = np.block([[truth["M"], A.T], [A, np.zeros((9, 9))]])
    solution = np.linalg.solve(matrix, np.concatenate([Q - truth["h"], -truth["c"]]))
    values |= dict(zip((f"{name}_ddot" for name in COORDINATES), solution[:12], strict=True))
    values |= dict(zip(INPUTS, u, strict=True))
    gamma = np.concatenate([-np.linalg.solve(A[:, :9], truth["c"]), np.zeros(3)])
    more = {"Q": Q, "N": N, "gamma": gamma, "delta": np.linalg.det(A[:, :9]), "u": u, "v": v}
    more["correction"] = np.concatenate([-np.linalg.solve(A[:, :9], truth["Phi"]), np.zeros(3)])
    return Sample(values, truth | more | {"q_dot": N @ v, "q_ddot": solution[:12], "lam": solution[12:]})


def _parameters(rng: np.random.Generator) -> dict[str, float]:
    values = dict(zip(PARAMETERS, rng.uniform(0.3, 1.5, len(PARAMETERS)), strict=True))
    values |= {"b": 0.3 * values["b"], "g": 9.8 * values["g"]}
    inertia = values["M"] * values["b"] ** 2 * rng.uniform(0.2, 0.35, 3)
    return values | dict(zip(("Ixx", "Iyy", "Izz"), inertia, strict=True))


def _pose(rng: np.random.Generator) -> NDArray[np.float64]:
    place, angles = rng.uniform(-0.3, 0.3, 3), rng.uniform(-0.4, 0.4, 3)
    return np.concatenate([place, angles, rng.uniform(0.7, 2.4, 3), rng.uniform(0.2, 0.8, 3)])


def all_outputs(equations: Equations) -> dict[str, Any]:
    """The named outputs, and those of the routines as "routine.output"."""
    routines = {f"{name}.{key}": f for name, r in equations.routines.items() for key, f in r.outputs.items()}
    return {**equations.outputs, **routines}


def evaluate(outputs: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, NDArray[np.float64]]:
    """The outputs at values of the symbols, by the interpreter."""
    expressions: list[Expr] = [f for output in outputs.values() for f in flat(output)]
    found = np.zeros(len(expressions))
    for graph in {id(f.graph): f.graph for f in expressions}.values():
        places = [k for k, f in enumerate(expressions) if f.graph is graph]
        found[places] = Tape.of([expressions[k] for k in places], tuple(values)).run(list(values.values()))
    return arranged(outputs, found)


def arranged(outputs: Mapping[str, Any], numbers: Iterable[float]) -> dict[str, NDArray[np.float64]]:
    """Numbers in the order of the outputs' expressions, as arrays by name."""
    left, found = iter(numbers), {}
    for name, output in outputs.items():
        size = shape(output)
        found[name] = np.array([next(left) for _ in range(int(np.prod(size)))]).reshape(size)
    return found
