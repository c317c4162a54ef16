"""Trajectory: what a simulation returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.kinematics import project
from nullbody.model import Model, State
from nullbody.simulate.integration import interpolated
from nullbody.simulate.outcome import Outcome
from nullbody.tolerances import CLOSED_STEP
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    import xarray

__all__ = ["Sample", "Statistics", "Trajectory"]


class Sample(NamedTuple):
    """q (times x nq) and v (times x nv) at any times t."""

    t: FloatArray
    q: FloatArray
    v: FloatArray


@dataclass(frozen=True)
class Statistics:
    """What a simulation cost and how well it kept what should be kept.

    Attributes:
        steps: accepted steps.
        evaluations: calls of the forward dynamics.
        projections: steps after which the loops were closed again.
        residual: largest |Phi| at a stored sample [m].
        energy_drift: largest |T + U - work of the inputs - initial value| [J].
        seconds: wall time [s].
    """

    steps: int
    evaluations: int
    projections: int
    residual: float
    energy_drift: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A simulated motion.

    Attributes:
        model: the model that moved.
        t: times of the stored samples [s].
        q: coordinates, times x nq [m, rad].
        v: independent rates, times x nv.
        u: inputs, times x nu [N, N m].
        kinetic, potential, work: energies and the work done by the inputs [J].
        outcome: how it ended.
        statistics: cost, closures, energy balance.
    """

    model: Model
    t: FloatArray
    q: FloatArray
    v: FloatArray
    u: FloatArray
    kinetic: FloatArray
    potential: FloatArray
    work: FloatArray
    outcome: Outcome
    statistics: Statistics
    _knots: FloatArray
    _pieces: tuple[Callable[[float], FloatArray], ...]

    def __getitem__(self, name: object) -> FloatArray:
        """A coordinate over the stored samples, by name; `name'` (with a prime) is the rate of an independent one."""
        model = self.model
        if name in model.coordinates:
            return self.q[:, model.coordinates.index(name)]
        if isinstance(name, str) and name.endswith("'") and name[:-1] in model.independent:
            return self.v[:, model.independent.index(name[:-1])]
        if name in model.inputs:
            return self.u[:, model.inputs.index(name)]
        rates = (f"{rate}'" for rate in model.independent)
        raise UnknownName("coordinate, rate or input", name, (*model.coordinates, *rates, *model.inputs))

    def __len__(self) -> int:
        return len(self.t)

    def state(self, t: float) -> State:
        """The state at any time of the simulation."""
        _, q, v = self.sample([t])
        return self.model.trusted_state(q[0], v[0])

    def sample(self, t: Sequence[float] | FloatArray) -> Sample:
        """Dense output: q and v at any times, of the order of the method, with the loops closed.

        Raises:
            InputError: a time outside the simulation.
        """
        first, last = self._knots[0], self._knots[-1]
        try:
            times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        except (TypeError, ValueError):
            times = np.array([np.nan])
        if times.ndim != 1 or not np.isfinite(times).all() or (times < first).any() or (times > last).any():
            raise InputError(f"times must be a list within {first:g}..{last:g} s, what was simulated")
        nq = len(self.model.coordinates)
        q, v = np.empty((len(times), nq)), np.empty((len(times), len(self.model.independent)))
        for k, time in enumerate(times):
            if not self._pieces:
                q[k], v[k] = self.q[0], self.v[0]
                continue
            y = interpolated(self._knots, self._pieces, float(time))
            q[k], v[k] = y[:nq], y[nq : nq + v.shape[1]]
            if np.abs(self.model.residual(q[k])).max(initial=0.0) > CLOSED_STEP:
                q[k] = project(self.model, q[k])[0]
        return Sample(times, q, v)

    def to_xarray(self) -> xarray.Dataset:
        """All stored samples as an xarray Dataset, with units, parameters and statistics as attributes."""
        import xarray

        model = self.model
        units = model.mechanism.units
        data: dict[str, Any] = {}
        for k, name in enumerate(model.coordinates):
            data[name] = ("t", self.q[:, k], {"units": units[name], "long_name": f"coordinate {name}"})
        for k, name in enumerate(model.independent):
            data[f"{name}_dot"] = ("t", self.v[:, k], {"units": f"{units[name]}/s", "long_name": f"rate of {name}"})
        for k, actuator in enumerate(model.mechanism.actuators):
            unit = "N" if units[actuator.coordinate] == "m" else "N m"
            data[actuator.name] = ("t", self.u[:, k], {"units": unit, "long_name": f"input {actuator.name}"})
        for name, values in (("kinetic", self.kinetic), ("potential", self.potential), ("work", self.work)):
            data[f"{name}_energy" if name != "work" else name] = ("t", values, {"units": "J"})
        attributes = {
            "mechanism": model.mechanism.name,
            "outcome": self.outcome.name,
            **{f"parameter_{name}": value for name, value in model.parameters.items()},
            **{f"statistics_{name}": value for name, value in vars(self.statistics).items()},
        }
        return xarray.Dataset(data, coords={"t": ("t", self.t, {"units": "s"})}, attrs=attributes)

    def __repr__(self) -> str:
        s = self.statistics
        return (
            f"<Trajectory {self.t[-1] - self.t[0]:.3g} s, {s.steps} steps, energy drift {s.energy_drift:.1e} J, "
            f"closure {s.residual:.1e} m, {self.outcome.name.lower()}>"
        )
