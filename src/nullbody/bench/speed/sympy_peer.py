"""What a user of SymPy writes: M, h, A, c of all coordinates by SymPy itself, lambdified, and a dense solve of NumPy.

Only the joints' poses are this package's; velocities, accelerations and derivatives are SymPy's:

    J = dp/dq,  W_j = (R^T dR/dq_j)^vee,  p'' and W' for q'' = 0
    M = sum m J^T J + W^T I W,  h = sum m J^T (p'' - g) + W^T (I W' q' + omega x I omega),  A = dPhi/dq,  c = (A q')' q'
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.bench.speed.interleave import CLOCK
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.formats import frame, loop_points, mass_properties, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray

__all__ = ["SympyDynamics", "sympy_dynamics"]

_ROUNDING = 1e-15


@dataclass(frozen=True)
class SympyDynamics:
    """The function that SymPy made.

    Attributes:
        seconds: to derive and lambdify it [s].
        operations: of the code, after `cse`.
    """

    seconds: float
    operations: int
    _function: Callable[..., Sequence[float]]
    _size: int
    _rows: int
    _S: FloatArray

    def forward_dynamics(self, q: FloatArray, q_dot: FloatArray, u: FloatArray) -> FloatArray:
        """q'' from [M A^T; A 0] [q''; lambda] = [S u - h; -c]."""
        n, m = self._size, self._rows
        flat = np.array(self._function(*q.tolist(), *q_dot.tolist()))
        matrix, right = np.zeros((n + m, n + m)), np.empty(n + m)
        parts = np.split(flat, np.cumsum([n * n, n, m * n]))
        M, h, A, c = parts
        matrix[:n, :n] = M.reshape(n, n)
        matrix[n:, :n] = A.reshape(m, n)
        matrix[:n, n:] = A.reshape(m, n).T
        right[:n] = self._S @ u - h
        right[n:] = -c
        return np.asarray(np.linalg.solve(matrix, right)[:n], dtype=np.float64)


def sympy_dynamics(mechanism: Mechanism, values: Mapping[str, float], S: FloatArray, patience: float) -> SympyDynamics:
    """Derive the equations of a mechanism whose loops hold points together.

    Args:
        mechanism: no loads, no other constraints.
        values: of all parameters; they enter as numbers.
        S: which coordinate each input acts along.
        patience: seconds after which it is given up.

    Raises:
        Missing: SymPy is not installed.
        Stopped: it took longer.
    """
    try:
        import sympy
    except ImportError:
        raise Missing('SymPy is not installed; run: python -m pip install "nullbody[symbolic]"') from None
    begin, started = time.perf_counter(), CLOCK()

    def check() -> None:
        if time.perf_counter() - begin > patience:
            raise Stopped(f"not derived within {patience:g} s")

    work = _Derivation(sympy, mechanism, values, check)
    entries = [*work.M, *work.h, *work.A, *work.c]
    check()
    shared, reduced = sympy.cse(entries)
    check()
    function = sympy.lambdify([*work.q, *work.v], entries, modules="math", cse=lambda _: (shared, reduced))
    operations = sum(e.count_ops() for _, e in shared) + sum(e.count_ops() for e in reduced)
    return SympyDynamics(CLOCK() - started, int(operations), function, len(work.q), len(work.c), S)


class _Derivation:
    """Symbols q, v = q', and M, h, A, c as SymPy matrices."""

    def __init__(self, sympy: Any, mechanism: Mechanism, values: Mapping[str, float], check: Callable[[], None]):
        self._sympy, self._values, self._check = sympy, values, check
        self.q = [sympy.Symbol(name) for name in mechanism.coordinates]
        self.v = [sympy.Symbol(f"{name}_dot") for name in mechanism.coordinates]
        n = len(self.q)
        poses = self._poses(mechanism)
        gravity = self._column(triple(mechanism.gravity, values))
        self.M, self.h = sympy.zeros(n, n), sympy.zeros(n, 1)
        for body in mechanism.bodies:
            self._add(mass_properties(body, values), poses[body.name], gravity)
            check()
        gaps = []
        for loop in mechanism.loops:
            a, b = loop_points(loop, values)
            gaps.append(self._point(poses[loop.parent], a) - self._point(poses[loop.child], b))
        self.A = self._jacobian(sympy.Matrix.vstack(*gaps))
        self.c = self._rate(self.A * sympy.Matrix(self.v))

    def _add(self, mass_of_body: tuple[float, FloatArray, FloatArray], pose: tuple[Any, Any], gravity: Any) -> None:
        """What one body adds to M and h."""
        sympy, (R, _), (mass, centre, inertia) = self._sympy, pose, mass_of_body
        v, p = sympy.Matrix(self.v), self._point(pose, centre)
        J = self._jacobian(p)
        self.M += mass * J.T * J
        self.h += mass * J.T * (self._rate(J * v) - gravity)
        if not np.any(inertia):
            return
        I = self._matrix(inertia)  # noqa: E741 - its name
        W = sympy.Matrix.hstack(*(self._vee(R.T * R.diff(q)) for q in self.q))
        omega = W * v
        self.M += W.T * I * W
        self.h += W.T * (I * self._rate(omega) + omega.cross(I * omega))

    def _poses(self, mechanism: Mechanism) -> dict[str, tuple[Any, Any]]:
        sympy = self._sympy
        symbols = dict(zip(mechanism.coordinates, self.q, strict=True))
        poses = {GROUND: (sympy.eye(3), sympy.zeros(3, 1))}
        for joint in mechanism.tree_order():
            at, back = frame(joint.at, self._values), frame(joint.on, self._values).inverse()
            motion = joint.motion([symbols[name] for name in joint.coordinates], sympy.sin, sympy.cos).pose
            R, p = poses[joint.parent]
            for turn, shift in (
                (self._matrix(at.rotation), self._column(at.position)),
                (sympy.Matrix(motion.rotation), sympy.Matrix(motion.position)),
                (self._matrix(back.rotation), self._column(back.position)),
            ):
                R, p = R * turn, p + R * shift
            poses[joint.child] = R, p
            self._check()
        return poses

    def _point(self, pose: tuple[Any, Any], local: FloatArray) -> Any:
        return pose[1] + pose[0] * self._column(local)

    def _jacobian(self, column: Any) -> Any:
        return column.jacobian(self.q)

    def _rate(self, column: Any) -> Any:
        """d/dt with q' = v and v' = 0."""
        return self._jacobian(column) * self._sympy.Matrix(self.v)

    def _vee(self, skew: Any) -> Any:
        return self._sympy.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])

    def _matrix(self, rows: FloatArray) -> Any:
        return self._sympy.Matrix([[self._number(x) for x in row] for row in np.asarray(rows).tolist()])

    def _column(self, entries: FloatArray | Sequence[float]) -> Any:
        return self._sympy.Matrix([self._number(x) for x in np.asarray(entries).tolist()])

    def _number(self, x: float) -> Any:
        """Whole numbers as such, so that 0 and 1 drop out."""
        whole = round(x)
        return self._sympy.Integer(whole) if abs(x - whole) < _ROUNDING else self._sympy.Float(x)
