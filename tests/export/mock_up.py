"""Units of several mechanisms, run by FMPy: another program's reader, host, and integrator (CVode)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import nullbody
from nullbody import Model, State

__all__ = ["CASES", "Ran", "errors", "flat", "run", "shaken", "start_of"]


@dataclass(frozen=True)
class Ran:
    """What a host saw: a column for each name, and what the unit logged."""

    columns: Any
    log: list[str] = field(default_factory=list)

    def __getitem__(self, name: str) -> np.ndarray:
        return self.columns[name]

    @property
    def t(self) -> np.ndarray:
        return self.columns["time"]


def run(path: Path, kind: str, until: float, names: Sequence[str], **options: Any) -> Ran:
    """Simulate a unit with FMPy; kind is CoSimulation or ModelExchange."""
    import fmpy

    log: list[str] = []

    def heard(_host: object, _name: object, _status: object, _category: object, message: bytes) -> None:
        log.append(message.decode())

    options = {"output_interval": until / 10, "start_time": 0.0} | options
    options["stop_time"] = options["start_time"] + until
    columns = fmpy.simulate_fmu(str(path), fmi_type=kind, output=list(names), logger=heard, validate=True, **options)
    return Ran(columns, log)


def shaken() -> nullbody.Mechanism:
    """A pendulum on a cart that a driver shakes: the time enters."""
    b = nullbody.MechanismBuilder("shaken pendulum 1.0", gravity=(0, 0, -9.81))
    b.box("cart", mass=1.0, size=(0.1, 0.1, 0.1))
    b.rod("arm", mass=0.3, length=0.5, axis="-z", radius=0.01)
    b.prismatic("rail", "ground", "cart", axis="x")
    b.revolute("swing", "cart", "arm", axis="y")
    b.driver("the.shaker", "rail", "0.05*sin(4*t)")
    return b.build()


def flat(name: str) -> nullbody.Mechanism:
    """A pendulum on a driven cart whose driver has the given name."""
    b = nullbody.MechanismBuilder("named", gravity=(0, 0, -9.81))
    b.point_mass("cart", 1.0)
    b.point_mass("bob", 0.5, centre=(0, 0, -1))
    b.prismatic("rail", "ground", "cart", axis="x")
    b.revolute("swing", "cart", "bob", axis="y")
    b.driver(name, "rail", "0.1*t")
    return b.build()


def _hanging(model: Model) -> State:
    below = {"y": -0.5, "alpha1": -1.5, "alpha2": -1.5, "alpha3": -1.5}
    return nullbody.assemble(model, {"s1": 0.55, "s2": 0.6, "s3": 0.62}, v=[0.1, 0.0, -0.1], guess=below)


def _turning(model: Model) -> State:
    return nullbody.assemble(model, {}, v=np.linspace(0.2, -0.3, len(model.independent)))


def _rolling(model: Model) -> State:
    coin = nullbody.catalog.starts("rolling_disc")["coin"]
    return model.own(nullbody.consistent(model, coin.q, coin.q_dot).state)


def _swinging(model: Model) -> State:
    return nullbody.assemble(model, {"swing": 0.4}, v=[0.3])


#: Mechanism, start, seconds, constant inputs.
CASES: Mapping[str, tuple[Callable[[], nullbody.Mechanism], Callable[[Model], State], float, Sequence[float]]] = {
    "three_prs": (nullbody.catalog.three_prs, _hanging, 0.5, (0.8, -0.4, 0.3)),
    "four_bar": (lambda: nullbody.catalog.mechanism("four_bar"), _turning, 0.5, (0.4,)),
    "shaken": (shaken, _swinging, 1.0, ()),
    "rolling_disc": (lambda: nullbody.catalog.starts("rolling_disc")["coin"].mechanism, _rolling, 0.05, (2e-5, 1e-5)),
    "chaplygin_sleigh": (lambda: nullbody.catalog.mechanism("chaplygin_sleigh"), _turning, 1.0, (0.1,)),
    "stewart_platform": (
        lambda: nullbody.catalog.mechanism("stewart_platform"), _turning, 0.2, (3.0, 1.0, 0.0, -1.0, 2.0, 0.5)
    ),
}  # fmt: skip


def start_of(name: str) -> tuple[nullbody.Equations, Model, State]:
    """Equations, model and start of a case."""
    mechanism, start, _, _ = CASES[name]
    equations = nullbody.derive(mechanism())
    model = nullbody.build(equations)
    return equations, model, start(model)


def errors(ran: Ran, found: nullbody.Trajectory, names: Sequence[str]) -> float:
    """The largest difference of coordinates over all samples."""
    assert np.allclose(ran.t, found.t, rtol=0, atol=1e-12)
    return max(float(np.abs(ran[name] - found[name]).max()) for name in names)
