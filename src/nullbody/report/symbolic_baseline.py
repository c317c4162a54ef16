"""Symbolic null spaces of the 3-PRS by SymPy, each in a process of its own that can be stopped.

`python -m nullbody.report.symbolic_baseline METHOD` makes A in SymPy from the closures [26] (without this package's
equations), runs the method, and prints a line when it begins and one line of
JSON when it is done: seconds, and whether N is right at a state of the robot.

    gauss_jordan      fixed order, pivot = first entry of the column that `simplify` does not show to be zero
    structural        the same with SymPy's structural zero test: what is not written as 0 is a pivot
    by_value          the same with the zero test and the pivot chosen by value at a state of the robot
    nullspace         Matrix.nullspace(), SymPy's own
    cramer_solve      Matrix.cramer_solve: determinants by Laplace expansion (SymPy 1.13; pull request 25179)
    lu_solve          Matrix.LUsolve
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

__all__ = ["METHODS", "main"]

_INDEPENDENT = 3
_STATE = {"psi": 0.11, "theta": -0.07, "phi": 0.05, "y": 0.45}  # a tilted pose; the rest follows from the closures


def main(method: str) -> None:
    """Run one method and print what came of it."""
    A, symbols = constraint_matrix()
    state = _state(symbols)
    print("ready", flush=True)
    begin = time.perf_counter()
    N = METHODS[method](A, state)
    report: dict[str, Any] = {"seconds": time.perf_counter() - begin}
    report["residual"] = _residual(A, N, state)
    print(json.dumps(report))


def constraint_matrix() -> tuple[Any, dict[str, Any]]:
    """A = df/dq in SymPy, from f = B_leg - p - R b e_i, with sqrt(3) exact, and the symbols by name."""
    from sympy import Matrix, Rational, cos, sin, sqrt, symbols

    names = "x y z psi theta phi alpha1 alpha2 alpha3 s1 s2 s3 a b l"
    known = dict(zip(names.split(), symbols(names, real=True), strict=True))
    x, y, z, psi, theta, phi = (known[name] for name in names.split()[:6])
    a, b, length = known["a"], known["b"], known["l"]
    turn_z = Matrix([[cos(phi), -sin(phi), 0], [sin(phi), cos(phi), 0], [0, 0, 1]])
    turn_y = Matrix([[cos(theta), 0, sin(theta)], [0, 1, 0], [-sin(theta), 0, cos(theta)]])
    turn_x = Matrix([[1, 0, 0], [0, cos(psi), -sin(psi)], [0, sin(psi), cos(psi)]])
    R, half = turn_z * turn_y * turn_x, Rational(1, 2)
    closures: list[Any] = []
    for i, e in enumerate(([0, 0, 1], [sqrt(3) / 2, 0, -half], [-sqrt(3) / 2, 0, -half]), 1):
        rail, alpha = Matrix(e), known[f"alpha{i}"]
        leg = (a - known[f"s{i}"]) * rail + length * (sin(alpha) * Matrix([0, 1, 0]) - cos(alpha) * rail)
        closures += list(leg - Matrix([x, y, z]) - b * R * rail)
    return Matrix(closures).jacobian([known[name] for name in names.split()[:12]]), known


def _state(symbols: dict[str, Any]) -> dict[Any, float]:
    """Numbers at which A is that of an assembled robot: angles of a tilted platform and the legs that reach it."""
    import math

    values = {"a": 0.8, "b": 0.2, "l": 0.5, **_STATE}
    cx, sx = math.cos(values["psi"]), math.sin(values["psi"])
    cy, sy = math.cos(values["theta"]), math.sin(values["theta"])
    cz, sz = math.cos(values["phi"]), math.sin(values["phi"])
    R = (
        (cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx),
        (sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx),
        (-sy, cy * sx, cy * cx),
    )
    for i, (ex, ez) in enumerate(((0.0, 1.0), (math.sqrt(3) / 2, -0.5), (-math.sqrt(3) / 2, -0.5)), 1):
        height = values["y"] + values["b"] * (R[1][0] * ex + R[1][2] * ez)
        values[f"alpha{i}"] = math.asin(height / values["l"])
    return {symbols[name]: value for name, value in values.items()}


def _gauss_jordan(A: Any, is_zero: Callable[[Any, int, int], bool], shadow: list[list[float]] | None) -> Any:
    """[B | C] to [I | B^-1 C] by row operations in fixed order; N = [-B^-1 C; I]."""
    from sympy import Matrix, eye

    rows, size = A.shape
    R = [list(A.row(i)) for i in range(rows)]
    for k in range(rows):
        order = list(range(k, rows))
        if shadow is not None:
            order.sort(key=lambda i: -abs(shadow[i][k]))
        pivot = next(i for i in order if not is_zero(R[i][k], i, k))
        for table in (R,) if shadow is None else (R, shadow):
            table[k], table[pivot] = table[pivot], table[k]
            head = table[k][k]
            table[k] = [entry / head for entry in table[k]]
            for i in range(rows):
                factor = table[i][k]
                if i != k and factor != 0:
                    table[i] = [entry - factor * lead for entry, lead in zip(table[i], table[k], strict=True)]
    return Matrix(rows, size - rows, lambda i, j: -R[i][rows + j]).col_join(eye(size - rows))


def _by_simplify(A: Any, state: Any) -> Any:
    from sympy import simplify

    return _gauss_jordan(A, lambda entry, i, k: entry == 0 or simplify(entry) == 0, None)


def _structural(A: Any, state: Any) -> Any:
    return _gauss_jordan(A, lambda entry, i, k: entry == 0, None)


def _by_value(A: Any, state: Any) -> Any:
    shadow = [[float(entry.subs(state)) for entry in A.row(i)] for i in range(A.rows)]
    return _gauss_jordan(A, lambda entry, i, k: entry == 0 or abs(shadow[i][k]) < 1e-9, shadow)


def _nullspace(A: Any, state: Any) -> Any:
    from sympy import Matrix

    return Matrix.hstack(*A.nullspace())


def _cramer(A: Any, state: Any) -> Any:
    return _completed(A, A[:, : A.rows].cramer_solve(A[:, A.rows :]))


def _lu(A: Any, state: Any) -> Any:
    return _completed(A, A[:, : A.rows].LUsolve(A[:, A.rows :]))


def _completed(A: Any, solution: Any) -> Any:
    from sympy import eye

    return (-solution).col_join(eye(A.cols - A.rows))


METHODS: dict[str, Callable[[Any, Any], Any]] = {
    "gauss_jordan": _by_simplify,
    "structural": _structural,
    "by_value": _by_value,
    "nullspace": _nullspace,
    "cramer_solve": _cramer,
    "lu_solve": _lu,
}


def _residual(A: Any, N: Any, state: dict[Any, float]) -> float | None:
    """max |A N| / (|A| |N|) at the state; nothing where N is not finite there."""
    import numpy as np

    values: dict[Any, complex] = dict(state)
    try:
        a = np.array([[_value(entry, values) for entry in A.row(i)] for i in range(A.rows)], dtype=float)
        n = np.array([[_value(entry, values) for entry in N.row(i)] for i in range(N.rows)], dtype=float)
    except (ZeroDivisionError, OverflowError):
        return None
    size = float(np.abs(a).max() * np.abs(n).max())
    return float(np.abs(a @ n).max() / size) if np.isfinite(size) and size > 0 else None


def _value(expression: Any, known: dict[Any, Any]) -> Any:
    """The value of an expression, each shared part once."""
    if expression in known:
        return known[expression]
    if expression.is_Number or not expression.args:
        result: Any = float(expression)
    else:
        parts = [_value(part, known) for part in expression.args]
        result = _apply(expression, parts)
    known[expression] = result
    return result


def _apply(expression: Any, parts: list[Any]) -> Any:
    import math

    if expression.is_Add:
        return math.fsum(parts)
    if expression.is_Mul:
        return math.prod(parts)
    if expression.is_Pow:
        return parts[0] ** parts[1]
    return getattr(math, type(expression).__name__)(*parts)


if __name__ == "__main__":
    sys.setrecursionlimit(100_000)
    main(sys.argv[1])
