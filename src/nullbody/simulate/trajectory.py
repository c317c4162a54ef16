"""Trajectory: what a simulation returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.model import Model, State
from nullbody.simulate.event import Happened
from nullbody.simulate.moments import at_times
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.piece import Piece, at_time
from nullbody.tolerances import LARGE_SPREAD
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
        evaluations: calls of the forward dynamics in attempts of steps.
        projections: steps after which the loops were closed again.
        switches: changes of the independent coordinates.
        crossings: configuration singularities that were passed.
        residual: largest |Phi| at a stored sample [m].
        energy_drift: largest |T + U - work - initial value| [J].
        seconds: wall time [s].
    """

    steps: int
    evaluations: int
    projections: int
    switches: int
    crossings: int
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
        q_dot: their rates [m/s, rad/s].
        u: inputs, times x nu [N, N m].
        kinetic, potential, work: energies, and the work of inputs, drives and loads without a potential [J].
        events: what happened on the way.
        outcome: how it ended.
        statistics: cost, closures, energy balance.
    """

    model: Model
    t: FloatArray
    q: FloatArray
    q_dot: FloatArray
    u: FloatArray
    kinetic: FloatArray
    potential: FloatArray
    work: FloatArray
    events: tuple[Happened, ...]
    outcome: Outcome
    statistics: Statistics
    _pieces: tuple[Piece, ...]

    @property
    def v(self) -> FloatArray:
        """Rates of the model's independent coordinates at the stored samples [m/s, rad/s]."""
        rates = self.q_dot[:, self.model.independent_columns]
        rates.flags.writeable = False
        return rates

    def __getitem__(self, name: object) -> FloatArray:
        """A coordinate or an input over the stored samples, by name; `name'` (with a prime) is a coordinate's rate."""
        model = self.model
        if name in model.coordinates:
            return self.q[:, model.coordinates.index(name)]
        if isinstance(name, str) and name.endswith("'") and name[:-1] in model.coordinates:
            return self.q_dot[:, model.coordinates.index(name[:-1])]
        if name in model.inputs:
            return self.u[:, model.inputs.index(name)]
        rates = (f"{name}'" for name in model.coordinates)
        raise UnknownName("coordinate, rate or input", name, (*model.coordinates, *rates, *model.inputs))

    def __len__(self) -> int:
        return len(self.t)

    @property
    def charts(self) -> tuple[tuple[float, tuple[str, ...]], ...]:
        """From when on [s] which coordinates were the independent ones: those that the integration used."""
        used: list[tuple[float, tuple[str, ...]]] = []
        for piece in self._pieces:
            independent = piece.motion.chart.independent
            if not used or used[-1][1] != independent:
                used.append((piece.t0, independent))
        return tuple(used)

    def state(self, t: float) -> State:
        """The state at any time of the simulation; where the model's independent coordinates are poor, in others."""
        moment = float(self._moments([t])[0])
        if not self._pieces:
            return self.model.trusted_state(self.q[0].copy(), self.v[0].copy(), float(self.t[0]))
        piece = at_time(self._pieces, moment)
        motion, y = piece.motion, piece.y(moment)
        state = motion.state(moment, y)
        spread = self.model.evaluate("kinematics", state.q, state.v, t=moment)[4]
        if spread < LARGE_SPREAD or motion.chart.independent == self.model.independent:
            return state
        v = y[motion.nq : motion.nq + motion.nv].copy()
        return motion.chart.trusted_state(state.q, v, moment)

    def sample(self, t: Sequence[float] | FloatArray) -> Sample:
        """Dense output: q and v at any times, of the order of the method, with the loops closed.

        Raises:
            InputError: a time outside the simulation.
        """
        times = self._moments(t)
        columns = self.model.independent_columns
        if not self._pieces:
            return Sample(times, np.repeat(self.q[:1], len(times), 0), np.repeat(self.v[:1], len(times), 0))
        q, v = np.empty((len(times), len(self.model.coordinates))), np.empty((len(times), len(columns)))
        done = 0
        for moments in at_times(self._pieces, times):
            here = slice(done, done + len(moments.t))
            q[here], v[here] = moments.q, moments.q_dot[:, columns]
            done = here.stop
        return Sample(times, q, v)

    def _moments(self, t: Sequence[float] | FloatArray) -> FloatArray:
        first = self._pieces[0].t0 if self._pieces else float(self.t[0])
        last = self._pieces[-1].t1 if self._pieces else float(self.t[0])
        try:
            times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        except (TypeError, ValueError):
            times = np.array([np.nan])
        if times.ndim != 1 or not np.isfinite(times).all() or (times < first).any() or (times > last).any():
            raise InputError(f"times must be a list within {first:g}..{last:g} s, what was simulated")
        return times

    def to_xarray(self) -> xarray.Dataset:
        """All stored samples as an xarray Dataset, with units, parameters and statistics as attributes."""
        import xarray

        model = self.model
        units = model.mechanism.units
        data: dict[str, Any] = {}
        for k, name in enumerate(model.coordinates):
            data[name] = ("t", self.q[:, k], {"units": units[name], "long_name": f"coordinate {name}"})
        for k, name in enumerate(model.coordinates):
            data[f"{name}_dot"] = ("t", self.q_dot[:, k], {"units": f"{units[name]}/s", "long_name": f"rate of {name}"})
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
