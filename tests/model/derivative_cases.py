"""Mechanisms whose derivatives are tested, with a state of each, and derivatives by complex steps of the tape."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import nullbody
from nullbody import Equations, Model, State, assemble, build, catalog, derive
from nullbody.equations import programs
from nullbody.kernels import Program
from nullbody.mechanism import Actuator, Mechanism
from tests.mechanisms import four_bar, two_bodies

__all__ = ["CASES", "COMPLEX", "QUICK", "Case", "agree", "case", "complex_steps"]

COMPLEX = {"sin": cmath.sin, "cos": cmath.cos, "sqrt": cmath.sqrt}


def cart() -> Mechanism:
    """A cart that follows the time carries a damped pendulum: b, gamma and c have parts of the time alone."""
    b = nullbody.MechanismBuilder("cart", gravity=(0, -9.81, 0), own="planar")
    b.parameter("amplitude", 0.2, "m")
    b.parameter("r", 0.3, "m")
    b.parameter("damping", 0.05, "N s/m")
    b.box("cart", 2.0, (0.1, 0.1, 0.1))
    b.rod("arm", 0.5, "r")
    b.prismatic("rail", "ground", "cart", axis="x")
    b.revolute("pin", "cart", "arm")
    b.driver("motor", "rail", "amplitude*sin(3*t)")
    b.damper("damper", "ground", "arm", "damping", at=(0.1, 0.6, 0), on=("r", 0, 0))
    b.actuator("torque", "pin")
    return b.build()


def drive() -> Mechanism:
    """A crank that follows the time: no degree of freedom is left."""
    b = nullbody.MechanismBuilder("drive", gravity=(0, -9.81, 0), own="planar")
    b.rod("crank", 0.5, 0.1)
    b.rod("rod", 0.4, 0.35)
    b.box("slider", 0.8, (0.05, 0.05, 0.05))
    b.revolute("shaft", "ground", "crank")
    b.revolute("pin", "crank", "rod", at=(0.1, 0, 0))
    b.revolute("wrist", "rod", "slider", at=(0.35, 0, 0))
    b.prismatic("rail", "ground", "slider", axis="x")
    b.driver("motor", "shaft", "8*t + 0.5*sin(8*t)")
    return b.build()


def started(name: str) -> Mechanism:
    """A mechanism of the catalog with the parameters of its first published motion."""
    return next(iter(catalog.starts(name).values())).mechanism


def unloaded() -> Mechanism:
    return replace(four_bar(), actuators=())


def loaded_twice() -> Mechanism:
    return replace(four_bar(), actuators=(Actuator("t1", "q1"), Actuator("t3", "q3")))


#: name: (mechanism, independent coordinates or None, values that assemble it or None for its home)
CASES: dict[str, tuple[Callable[[], Mechanism], Any, Any]] = {
    "four_bar": (four_bar, ("q1",), {"q1": 1.1}),
    "four_bar by its rocker": (four_bar, ("q3",), {"q3": 1.7}),
    "four_bar without inputs": (unloaded, ("q1",), {"q1": 1.1}),
    "four_bar with two inputs": (loaded_twice, ("q1",), {"q1": 1.1}),
    "three_prs": (catalog.three_prs, ("s1", "s2", "s3"), {"s1": 0.45, "s2": 0.5, "s3": 0.55}),
    "stewart_platform": (catalog.stewart_platform, None, {}),
    "n_four_bar": (lambda: catalog.n_four_bar(3), None, {}),
    "rolling_disc": (lambda: started("rolling_disc"), None, None),
    "chaplygin_sleigh": (lambda: started("chaplygin_sleigh"), None, None),
    "flyball_governor": (lambda: started("flyball_governor"), None, None),
    "two_bodies": (two_bodies, None, None),
    "cart": (cart, None, {}),
    "drive": (drive, None, {}),
}
QUICK = [name for name in CASES if name != "stewart_platform"]


class Case:
    """A mechanism's equations and model, and a state of it with rates and inputs at random."""

    def __init__(self, name: str) -> None:
        make, independent, known = CASES[name]
        self.equations: Equations = derive(make(), independent)
        self.model: Model = build(self.equations)
        self.draw = np.random.default_rng(len(name))
        if known is None:
            start = next(iter(catalog.starts(name).values())) if name in catalog.MODELS else None
            home = self.model.mechanism.home_values(self.model.parameters) if start is None else start.q
            at = self.model.state(home)
        else:
            at = assemble(self.model, known, t=0.2) if self.model.rheonomic else assemble(self.model, known)
        self.v = self.draw.normal(size=len(self.model.independent))
        self.u = self.draw.normal(size=len(self.model.inputs))
        self.v_dot = self.draw.normal(size=len(self.model.independent))
        self.state: State = self.model.state(at.q.copy(), self.v, t=at.t)

    def groups(self, routine: str) -> list[np.ndarray]:
        """What the routine's kernel takes at the state."""
        third = self.v_dot if routine == "inverse_dynamics" else self.u
        time = [np.array([self.state.t])] if self.model.rheonomic else []
        return [self.state.q, self.v, third, *time, np.array(self.model.values)]

    def program(self, routine: str) -> Program:
        return next(p for p in programs(self.equations) if p.name == routine)


@cache
def case(name: str) -> Case:
    return Case(name)


def complex_steps(program: Program, groups: list[np.ndarray], outputs: tuple[str, ...]) -> dict[str, np.ndarray]:
    """d outputs / d group by one complex step of the interpreter for every input."""
    at = np.concatenate(groups)
    columns = []
    for k in range(len(at)):
        shifted = at.astype(complex)
        shifted[k] += 1e-30j
        columns.append([complex(value).imag / 1e-30 for value in program.tape.run(list(shifted), COMPLEX)])
    J = np.array(columns).T.reshape(len(program.tape.outputs), len(at))
    rows, start = [], 0
    for name, shape in program.outputs:
        size = int(np.prod(shape))
        if name in outputs:
            rows += range(start, start + size)
        start += size
    edges = np.cumsum([size for _, size in program.inputs])[:-1]
    return dict(zip((name for name, _ in program.inputs), np.split(J[rows], edges, axis=1), strict=True))


def agree(found: np.ndarray, expected: np.ndarray, tolerance: float = 1e-10) -> None:
    assert found.shape == expected.shape
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * max(1.0, np.abs(expected).max(initial=0.0)))
