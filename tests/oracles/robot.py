"""The 3-PRS robot a second time, sharing nothing with the package: plain Lagrange in SymPy, from positions.

Every position is written in the ground frame as in theory 2, differentiated with respect to time, and

    T = sum 1/2 m |p_C'|^2 + 1/2 w^T I w,   U = sum m g y_C,   M = d^2 T / dq'^2,
    h = d/dt(dT/dq') - dT/dq + dU/dq at q'' = 0,   A = df/dq,   c = d/dt(A q') at q'' = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

__all__ = ["COORDINATES", "PARAMETERS", "robot"]

COORDINATES = ("x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "s1", "s2", "s3")
PARAMETERS = ("a", "b", "l", "M", "m", "g", "Ixx", "Iyy", "Izz", "ms")

q = sp.symbols(COORDINATES)
qd = sp.symbols([f"{name}_dot" for name in COORDINATES])
p = dict(zip(PARAMETERS, sp.symbols(PARAMETERS), strict=True))
UP = sp.Matrix([0, 1, 0])
HALF = sp.Rational(1, 2)
E = [sp.Matrix([0, 0, 1]), sp.Matrix([sp.sqrt(3) / 2, 0, -HALF]), sp.Matrix([-sp.sqrt(3) / 2, 0, -HALF])]


def rate(expression: Any) -> Any:
    """d/dt along q' (with q'' = 0)."""
    terms = [sp.diff(expression, x) * v for x, v in zip(q, qd, strict=True)]
    return sum(terms[1:], terms[0])


def slider(i: int) -> Any:
    """C_i = (a - s_i) e_i"""
    return (p["a"] - q[9 + i]) * E[i]


def along(i: int, distance: Any) -> Any:
    """A point of link i at this distance from its hinge."""
    return slider(i) + distance * (sp.sin(q[6 + i]) * UP - sp.cos(q[6 + i]) * E[i])


def platform() -> Any:
    """R = Rz(phi) Ry(theta) Rx(psi)"""
    cx, cy, cz = (sp.cos(angle) for angle in q[3:6])
    sx, sy, sz = (sp.sin(angle) for angle in q[3:6])
    Rx = sp.Matrix([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    Ry = sp.Matrix([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    Rz = sp.Matrix([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return Rz * Ry * Rx


def energies() -> tuple[Any, Any]:
    """(T, U), with the platform's spin from the skew matrix R^T R'.

    A rod is two thirds of its mass at the centre and a sixth at each end: the same mass, centre and moment.
    """
    turn = platform()
    skew = turn.T * rate(turn)
    spin = sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
    v = sp.Matrix(qd[:3])
    T = (p["M"] * v.dot(v) + sum(p[name] * w**2 for name, w in zip(("Ixx", "Iyy", "Izz"), spin, strict=True))) / 2
    U = p["M"] * p["g"] * q[1]
    for i in range(3):
        points = [(slider(i), p["ms"])]
        points += [(along(i, p["l"] * k / 2), p["m"] * sp.Rational(share, 6)) for k, share in enumerate((1, 4, 1))]
        for point, mass in points:
            velocity = rate(point)
            T += mass * velocity.dot(velocity) / 2
            U += mass * p["g"] * point[1]
    return T, U


@cache
def robot() -> Callable[[Mapping[str, float]], dict[str, NDArray[np.float64]]]:
    """robot()(values) -> Phi, A, c, M, h, T, U at values of the symbols, as arrays."""
    T, U = energies()
    closures = [along(i, p["l"]) - sp.Matrix(q[:3]) - platform() * p["b"] * E[i] for i in range(3)]
    Phi = sp.Matrix([entry for closure in closures for entry in closure])
    momentum = sp.Matrix([sp.diff(T, v) for v in qd])
    h = rate(momentum) - sp.Matrix([sp.diff(T - U, x) for x in q])
    A = Phi.jacobian(q)
    found = {"Phi": Phi, "A": A, "c": rate(A * sp.Matrix(qd)), "M": momentum.jacobian(qd), "h": h, "T": T, "U": U}
    names = [*COORDINATES, *(str(v) for v in qd), *PARAMETERS]
    function = sp.lambdify([*q, *qd, *p.values()], list(found.values()), "numpy", cse=True)
    vectors = {"Phi", "c", "h"}

    def evaluate(values: Mapping[str, float]) -> dict[str, NDArray[np.float64]]:
        results = function(*(values[name] for name in names))
        arrays = {name: np.asarray(result, float) for name, result in zip(found, results, strict=True)}
        return {name: array.ravel() if name in vectors else array for name, array in arrays.items()}

    return evaluate
