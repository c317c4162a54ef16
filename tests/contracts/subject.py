"""Every mechanism that the contracts are held against, with random states, and its equations as plain functions."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, sin, sqrt
from typing import Any, NamedTuple

import numpy as np

from nullbody import AssemblyError, Equations, Model, SingularityError, State, assemble, build, catalog, derive
from nullbody.equations import flat, shape
from nullbody.expr import Tape
from nullbody.mechanism import Mechanism
from tests.mechanisms import four_bar, slider_crank, two_bodies

__all__ = ["SUBJECTS", "Subject", "subject"]

#: name: (mechanism, independent coordinates or None for the package's own choice)
SUBJECTS: dict[str, tuple[Callable[[], Mechanism], tuple[str, ...] | None]] = {
    **{name: (make, None) for name, make in catalog.MODELS.items()},
    "three_prs by its platform": (catalog.three_prs, ("y", "psi", "phi")),
    "three_prs by its links": (catalog.three_prs, ("alpha1", "alpha2", "alpha3")),
    "three_prs with heavy sliders": (lambda: catalog.three_prs(ms=0.4, Ixx=0.02, Iyy=0.025, Izz=0.03), None),
    "four_bar": (four_bar, None),
    "four_bar by its rocker": (four_bar, ("q3",)),
    "slider_crank": (slider_crank, None),
    "slider_crank by its crank": (slider_crank, ("alpha",)),
    "two_bodies": (two_bodies, None),
}
_TAME = 20.0  # largest entry of N in states that are used


class Subject(NamedTuple):
    """A mechanism's equations, model and some states."""

    equations: Equations
    model: Model
    states: tuple[State, ...]

    def value(self, name: str, q: np.ndarray, q_dot: np.ndarray) -> np.ndarray:
        """An output of the equations by the tape's interpreter, not by a kernel."""
        names = [s for group in ("q", "q_dot", "u", "p") for s in self.equations.groups[group]]
        u = [0.0] * len(self.model.inputs)
        output: Any = self.equations[name]
        tape = Tape.of(list(flat(output)), names)
        found = tape.run([*q.tolist(), *q_dot.tolist(), *u, *self.model.values], {"sin": sin, "cos": cos, "sqrt": sqrt})
        return np.array(found, dtype=float).reshape(shape(output))

    @property
    def places(self) -> list[int]:
        """Where the independent coordinates are in q."""
        return [self.model.coordinates.index(name) for name in self.model.independent]

    @property
    def input_matrix(self) -> np.ndarray:
        """S: Q = S u."""
        columns = [[name == c for name in self.model.coordinates] for c in self.model.mechanism.actuated]
        return np.array(columns, dtype=float).reshape(len(columns), len(self.model.coordinates)).T


@cache
def subject(name: str) -> Subject:
    """A subject by name, with six states near its home."""
    make, independent = SUBJECTS[name]
    equations = derive(make(), independent)
    model = build(equations)
    home = assemble(model, {}, guess={c: 0.3 for c in model.coordinates if c == "swing"})
    return Subject(equations, model, tuple(_states(model, home, np.random.default_rng(11))))


def _states(model: Model, home: State, draw: np.random.Generator) -> list[State]:
    states: list[State] = []
    while len(states) < 6:
        spread = {name: abs(home[name]) if abs(home[name]) > 1e-6 else 0.5 for name in model.independent}
        known = {name: home[name] + draw.uniform(-0.2, 0.2) * spread[name] for name in model.independent}
        guess = {name: value + draw.uniform(-0.1, 0.1) for name, value in home.positions.items()}
        try:
            state = assemble(model, known, v=draw.normal(size=len(known)) * 0.5, guess={**guess, **known})
            N = model.null_space(state).N
        except (AssemblyError, SingularityError):
            continue
        if np.abs(N).max() < _TAME:
            states.append(state)
    return states
