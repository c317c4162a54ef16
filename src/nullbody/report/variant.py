"""The paper's variants of the dynamics, made from M, h, A, c and N of the correct model.

    equation 41     gamma = -A^T (A A^T)^-1 A' q', whose independent rows are not zero, taken for N' v
    m l^2/3         the links' inertia about their ends, at their centres (a model of its own)
    gravity -9.8    the platform's weight with the sign of [35]
    no coupling     M[alpha_i, s_i] = 0, and without the Coriolis force that belongs to it

The package itself has none of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nullbody.equations import derive, flat
from nullbody.expr import Tape
from nullbody.model import State, build
from nullbody.report.case import Case
from nullbody.report.run import end_inertia
from nullbody.typing import FloatArray
from nullbody.verify import admissible_states

__all__ = ["EQUATION_41", "GRAVITY", "INERTIA", "NO_COUPLING", "RIGHT", "Path", "Robot", "random_errors"]

RIGHT, EQUATION_41, INERTIA, GRAVITY, NO_COUPLING = "correct", "equation 41", "m l²/3", "gravity -9.8", "no coupling"

_SLIDERS, _ANGLES, _Y = slice(9, 12), slice(6, 9), 1
_FORCE = 10.0  # N, of random inputs: about the robot's weight


@dataclass(frozen=True, eq=False)
class _Terms:
    """M q'' + h + A^T lambda = Q,  A q'' + c = 0,  q' = N v at one state of the correct model."""

    M: FloatArray
    h: FloatArray
    A: FloatArray
    c: FloatArray
    N: FloatArray
    gamma: FloatArray
    q: FloatArray
    q_dot: FloatArray

    def accelerations(self, F: FloatArray, M: FloatArray, h: FloatArray) -> FloatArray:
        """v' from N^T M N v' = N^T (Q - h - M gamma), with other M and h."""
        Q = np.zeros(len(h))
        Q[_SLIDERS] = F
        found: FloatArray = np.asarray(np.linalg.solve(self.N.T @ M @ self.N, self.N.T @ (Q - h - M @ self.gamma)))
        return found

    def forces(self, v_dot: FloatArray, M: FloatArray, h: FloatArray, gamma: FloatArray | None = None) -> FloatArray:
        """F = N^T (M (N v' + gamma) + h), with other M, h and gamma."""
        offset = self.gamma if gamma is None else gamma
        found: FloatArray = self.N.T @ (M @ (self.N @ v_dot + offset) + h)
        return found

    @cached_property
    def least(self) -> FloatArray:
        """The paper's N' v [41]: gamma = -A^T (A A^T)^-1 A' q', whose independent rows are not zero."""
        found: FloatArray = -self.A.T @ np.linalg.solve(self.A @ self.A.T, self.c)
        return found


class Robot:
    """The correct model's terms at any state, interpreted from its equations, and the paper's variants of them."""

    def __init__(self, case: Case) -> None:
        self.model = case.model
        self._shortcut = build(derive(end_inertia(case.equations.mechanism), case.model.independent))
        equations = case.equations
        names = [*equations.coordinates, *(f"{name}_dot" for name in equations.coordinates), *case.model.parameters]
        self._tape = Tape.of([f for key in ("M", "h", "A", "c") for f in flat(equations[key])], names)

    def _terms(self, x: State) -> _Terms:
        """M, h, A, c, N, gamma at a state."""
        N, gamma, _ = self.model.null_space(x)
        q_dot = N @ x.v
        found = np.array(self._tape.run([*x.q.tolist(), *q_dot.tolist(), *self.model.values]))
        nq, nc = len(x.q), len(self.model.labels)
        M, h, A, c = np.split(found, np.cumsum([nq * nq, nq, nc * nq]))
        return _Terms(M.reshape(nq, nq), h, A.reshape(nc, nq), c, N, gamma, x.q, q_dot)

    def _wrong_gravity(self, terms: _Terms) -> FloatArray:
        """h with the platform's weight as [35] has it: -M g where [31] and [34] give +M g."""
        h = terms.h.copy()
        h[_Y] -= 2 * self.model.parameters["M"] * self.model.parameters["g"]
        return h

    def _uncoupled(self, terms: _Terms) -> tuple[FloatArray, FloatArray]:
        """M and h without M[alpha_i, s_i] = -m (l/2) sin(alpha_i) and the Coriolis force that belongs to it."""
        M, h = terms.M.copy(), terms.h.copy()
        M[_SLIDERS, _ANGLES] = 0
        M[_ANGLES, _SLIDERS] = 0
        half = self.model.parameters["m"] * self.model.parameters["l"] / 2
        h[_SLIDERS] += half * np.cos(terms.q[_ANGLES]) * terms.q_dot[_ANGLES] ** 2
        return M, h

    def forces(self, x: State, v_dot: FloatArray) -> dict[str, FloatArray]:
        """Slider forces for given slider accelerations, by variant [N]."""
        terms = self._terms(x)
        twin = self._shortcut.trusted_state(x.q.copy(), x.v.copy())
        return {
            RIGHT: terms.forces(v_dot, terms.M, terms.h),
            EQUATION_41: terms.forces(v_dot, terms.M, terms.h, terms.least),
            INERTIA: self._shortcut.inverse_dynamics(twin, v_dot),
            GRAVITY: terms.forces(v_dot, terms.M, self._wrong_gravity(terms)),
            NO_COUPLING: terms.forces(v_dot, *self._uncoupled(terms)),
        }

    def accelerations(self, x: State, F: FloatArray) -> dict[str, FloatArray]:
        """Slider accelerations for given slider forces, by variant [m/s^2]."""
        terms = self._terms(x)
        twin = self._shortcut.trusted_state(x.q.copy(), x.v.copy())
        shift = terms.N.T @ (terms.M @ (terms.gamma - terms.least))  # turns gamma of [39] into that of [41]
        return {
            RIGHT: terms.accelerations(F, terms.M, terms.h),
            EQUATION_41: terms.accelerations(F + shift, terms.M, terms.h),
            INERTIA: self._shortcut.forward_dynamics(twin, F)[_SLIDERS],
            GRAVITY: terms.accelerations(F, terms.M, self._wrong_gravity(terms)),
            NO_COUPLING: terms.accelerations(F, *self._uncoupled(terms)),
        }

    def fall(self, x: State) -> tuple[float, float]:
        """y'' of the platform let go from rest, with the printed and with the right sign of gravity [m/s^2]."""
        rest = self.model.trusted_state(x.q.copy(), np.zeros(len(x.v)))
        N, found = self.model.null_space(rest).N, self.accelerations(rest, np.zeros(len(x.v)))
        return float((N @ found[GRAVITY])[_Y]), float((N @ found[RIGHT])[_Y])


@dataclass(frozen=True, eq=False)
class Path:
    """Forces and accelerations along the desired motion, by variant (times x sliders)."""

    times: FloatArray
    forces: dict[str, FloatArray]
    accelerations: dict[str, FloatArray]

    @classmethod
    def of(cls, case: Case, robot: Robot) -> Path:
        """Inverse dynamics for the desired accelerations, forward dynamics for the right forces."""
        forces, accelerations = [], []
        for t in case.mark_times:
            x, v_dot = case.desired.state(float(t)), case.desired.demand(float(t)).acceleration
            forces.append(robot.forces(x, v_dot))
            accelerations.append(robot.accelerations(x, forces[-1][RIGHT]))
        return cls(case.mark_times, _stacked(forces), _stacked(accelerations))

    @cached_property
    def peak(self) -> float:
        """Largest right force [N]."""
        return float(np.abs(self.forces[RIGHT]).max())

    def worst(self, values: dict[str, FloatArray]) -> dict[str, float]:
        """Largest deviation of each variant from what is right."""
        return {name: float(np.abs(found - values[RIGHT]).max()) for name, found in values.items() if name != RIGHT}


def random_errors(case: Case, robot: Robot) -> dict[str, float]:
    """Median relative error of slider accelerations over random states with random forces, by variant."""
    random = np.random.default_rng(0)
    errors: dict[str, list[float]] = {}
    for x in admissible_states(case.model, case.settings.errata_states):
        found = robot.accelerations(x, _FORCE * random.normal(size=3))
        right = found.pop(RIGHT)
        for name, value in found.items():
            errors.setdefault(name, []).append(float(np.abs(value - right).max() / np.abs(right).max()))
    return {name: float(np.median(values)) for name, values in errors.items()}


def _stacked(rows: list[dict[str, FloatArray]]) -> dict[str, FloatArray]:
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
