"""Timings of the null space: symbolic, native, and by other methods on the same matrices."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.equations import Equations, flat
from nullbody.equations.closure import closures
from nullbody.equations.frame import frames
from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Graph, Operations, Tape, operations
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.mechanism import Mechanism
from nullbody.nullspace import null_space
from nullbody.report.case import Case
from nullbody.report.native import native_seconds
from nullbody.report.numeric_baseline import METHODS
from nullbody.typing import FloatArray
from nullbody.verify import admissible_states

__all__ = ["NumericSpeed", "SymbolicSpeed", "numeric_speed", "symbolic_speed"]

_STATES = 64  # random states that every numeric method goes through
_INDEPENDENT = 3


@dataclass(frozen=True)
class SymbolicSpeed:
    """Median seconds for N and N~ of the symbolic A, and how large they are."""

    seconds: float
    unscaled: Operations
    scaled: Operations


@dataclass(frozen=True)
class NumericSpeed:
    """Seconds for one numeric null space.

    Attributes:
        from_state: native, from (q, parameters) to N: sines, cosines and A included.
        from_matrix: native, from the entries of A to N, as the baselines.
        from_python: `model.evaluate("kinematics", q, v)` called from Python: N, gamma, q'.
        native_gauss_jordan: native, from the entries of A, by elimination compiled with the same compiler.
        baselines: other methods on the same A, by name.
        residual: largest |A N| / (|A| |N|) of ours over the states.
    """

    from_state: float
    from_matrix: float
    from_python: float
    native_gauss_jordan: float
    baselines: Mapping[str, float]
    residual: float


def symbolic_speed(case: Case) -> SymbolicSpeed:
    """Time the null space of the symbolic A, from a new graph each time, so that nothing is remembered."""
    mechanism = case.equations.mechanism
    free = [mechanism.coordinates.index(name) for name in case.equations.independent]
    seconds, space = [], None
    for _ in range(case.settings.repeats):
        A = _fresh_jacobian(mechanism)
        begin = time.perf_counter()
        space = null_space(A, free)
        sizes = len(space.basis), len(space.scaled)
        seconds.append(time.perf_counter() - begin)
        assert sizes[0] == sizes[1]
    entries = list(flat(case.equations["N"])), list(flat(case.equations["N_scaled"]))
    return SymbolicSpeed(float(np.median(seconds)), operations(entries[0]), operations(entries[1]))


def _fresh_jacobian(mechanism: Mechanism) -> list[list[Any]]:
    """A in a graph of its own."""
    graph = Graph()
    scalars = ParameterScalars(graph, tuple(p.name for p in mechanism.parameters))
    q = {name: graph.symbol(name) for name in mechanism.coordinates}
    rates = [graph.symbol(f"{name}_dot") for name in mechanism.coordinates]
    return closures(mechanism, frames(mechanism, scalars, q), scalars, list(q.values()), rates).A


def numeric_speed(case: Case) -> NumericSpeed:
    """Time all numeric methods over the same random states of the robot."""
    model, repeats = case.model, case.settings.repeats
    states = admissible_states(model, _STATES)
    matrices = [np.ascontiguousarray(model.jacobian(x.q)) for x in states]
    from_state, from_matrix, eliminated = _kernels(case.equations, matrices[0])
    parameters = np.array(model.values)
    rows = np.array([np.concatenate([x.q, parameters]) for x in states])
    flattened = np.array([A.ravel() for A in matrices])
    pairs = [(x.q, x.v) for x in states]
    residual = 0.0
    for A in matrices:
        N = from_matrix(A.ravel())[0]
        residual = max(residual, float(np.abs(A @ N).max() / (np.abs(A).max() * np.abs(N).max())))
    return NumericSpeed(
        from_state=native_seconds(from_state, rows, repeats),
        from_matrix=native_seconds(from_matrix, flattened, repeats),
        from_python=_per_call(lambda: [model.evaluate("kinematics", q, v) for q, v in pairs], len(pairs), repeats),
        native_gauss_jordan=native_seconds(eliminated, flattened, repeats),
        baselines={
            name: _per_call(lambda method=method: [method(A) for A in matrices], len(matrices), min(repeats, 5))  # type: ignore[misc]
            for name, method in METHODS.items()
        },
        residual=residual,
    )


def _per_call(run: Callable[[], object], calls: int, repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run()
        seconds.append((time.perf_counter() - begin) / calls)
    return float(np.median(seconds))


def _kernels(equations: Equations, A: FloatArray) -> tuple[Kernel, Kernel, Kernel]:
    """N from (q, p); N from the 108 entries of A; the same by Gauss-Jordan elimination, compiled alike."""
    nq, names = len(equations.coordinates), [*equations.coordinates, *equations.groups["p"]]
    shape = (nq, len(equations.independent))
    state = Program(
        "null_space_of_state",
        (("q", nq), ("p", len(equations.groups["p"]))),
        (("N", shape),),
        Tape.of(list(flat(equations["N"])), names),
    )
    symbols = [f"A_{i}_{j}" for i, j in np.ndindex(A.shape)]
    graph = Graph()
    free = [equations.coordinates.index(name) for name in equations.independent]
    entries = iter(symbols)
    known = [[_symbol_or_constant(graph, next(entries), entry) for entry in row] for row in equations["A"]]
    ours = null_space(known, free).basis
    dense = [[graph.symbol(f"A_{i}_{j}") for j in range(nq)] for i in range(len(A))]
    library = compile_programs(
        [
            state,
            *(_from_matrix(name, graph, N, symbols) for name, N in (("ours", ours), ("gauss", _eliminated(dense, A)))),
        ]
    )
    return library.kernels[state.name], library.kernels["ours"], library.kernels["gauss"]


def _symbol_or_constant(graph: Graph, name: str, entry: Any) -> Any:
    return graph.symbol(name) if entry.constant is None else graph.constant(entry.constant)


def _from_matrix(name: str, graph: Graph, N: Any, symbols: list[str]) -> Program:
    zero = graph.constant(0)
    tape = Tape.of([zero + entry for row in N for entry in row], symbols)
    return Program(name, (("A", len(symbols)),), (("N", (len(N), len(N[0]))),), tape)


def _eliminated(A: list[list[Any]], example: FloatArray) -> list[list[Any]]:
    """N by Gauss-Jordan elimination of all entries as straight-line code.

    The pivot rows are those of partial pivoting at an example, fixed: cheaper than the search of a safe program.
    """
    R, shadow = [list(row) for row in A], example.copy()
    rows, size = shadow.shape
    for k in range(rows):
        pivot = k + int(np.argmax(np.abs(shadow[k:, k])))
        R[k], R[pivot] = R[pivot], R[k]
        shadow[[k, pivot]] = shadow[[pivot, k]]
        inverse = 1 / R[k][k]
        R[k] = [entry * inverse for entry in R[k]]
        shadow[k] /= shadow[k, k]
        for i in range(rows):
            if i != k:
                factor = R[i][k]
                R[i] = [entry - factor * lead for entry, lead in zip(R[i], R[k], strict=True)]
                shadow[i] -= shadow[i, k] * shadow[k]
    identity = [[1 if i == j else 0 for j in range(size - rows)] for i in range(size - rows)]
    return [[-entry for entry in row[rows:]] for row in R] + identity
