"""BatchTrajectory: what a simulation of many robots returns."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError, UnknownName
from nullbody.model import Model, State
from nullbody.model.batch_inputs import numbers
from nullbody.simulate.outcome import Outcome
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    import xarray

__all__ = ["BatchStatistics", "BatchTrajectory", "contents"]

_OUTCOMES = tuple(Outcome)


@dataclass(frozen=True)
class BatchStatistics:
    """What a simulation of many robots cost.

    Attributes:
        steps: accepted steps of all robots together.
        refused: steps that were tried and made again shorter.
        switches: changes of independent coordinates.
        seconds: wall time [s].
        threads: how many worked at the same time.
    """

    steps: int
    refused: int
    switches: int
    seconds: float
    threads: int


@dataclass(frozen=True, eq=False)
class BatchTrajectory:
    """The motions of many robots at some times.

    Attributes:
        model: the model that moved.
        t: the times of the results [s].
        outcome: (robots,) the `Outcome` of every robot.
        ended: (robots,) when it ended [s]: the last time, or before, where it was stopped.
        accepted, refused: (robots,) steps.
        residual: (robots,) largest |Phi| at a result [m].
        energy_drift: (robots,) largest |T + U - work - initial value| at a result [J].
        parameters: values of all robots (robots, np), or (np,) where they share them.
        statistics: what it cost.
        path: the file with q and v, or None where they are in memory.
    """

    model: Model
    t: FloatArray
    outcome: NDArray[np.object_]
    ended: FloatArray
    accepted: NDArray[np.int64]
    refused: NDArray[np.int64]
    residual: FloatArray
    energy_drift: FloatArray
    parameters: FloatArray
    statistics: BatchStatistics
    path: Path | None
    _q: FloatArray | None
    _v: FloatArray | None

    @property
    def q(self) -> FloatArray:
        """Coordinates (times, robots, nq), NaN after a robot has ended [m, rad]; read from the file if there is one."""
        return self._stored("q", self._q)

    @property
    def v(self) -> FloatArray:
        """Rates of the independent coordinates (times, robots, nv), NaN after a robot has ended [m/s, rad/s]."""
        return self._stored("v", self._v)

    @property
    def completed(self) -> NDArray[np.bool_]:
        """Which robots reached the last time."""
        return np.array([outcome is Outcome.COMPLETED for outcome in self.outcome], dtype=bool)

    def counts(self) -> dict[Outcome, int]:
        """How many robots ended in each way."""
        return dict(Counter(self.outcome.tolist()).most_common())

    def __getitem__(self, name: object) -> FloatArray:
        """A coordinate of all robots (times, robots), by name; `name'` (with a prime) is an independent one's rate.

        Raises:
            UnknownName: there is no such coordinate or independent rate.
        """
        model = self.model
        if name in model.coordinates:
            return self.q[:, :, model.coordinates.index(name)]
        rates = tuple(f"{coordinate}'" for coordinate in model.independent)
        if name in rates:
            return self.v[:, :, rates.index(name)]
        raise UnknownName("coordinate or independent rate", name, (*model.coordinates, *rates))

    def alone(self, robot: int) -> tuple[Model, State]:
        """A robot by itself: the model with its parameters, and the last state that is stored of it.

        `nullbody.simulate` goes on from there, also where a batch cannot.

        Raises:
            InputError: there is no such robot.
        """
        if isinstance(robot, bool) or not isinstance(robot, Integral) or not 0 <= robot < len(self.outcome):
            raise InputError(f"there are robots 0 to {len(self.outcome) - 1}, not {robot!r}")
        model = self.model
        if self.parameters.ndim == 2 or self.parameters.tolist() != list(model.values):
            values = self.parameters[robot] if self.parameters.ndim == 2 else self.parameters
            model = model.replace(**dict(zip(model.parameters, values.tolist(), strict=True)))
        with self.to_xarray() as dataset:
            one = dataset[["q", "v"]].isel(robot=int(robot)).load()
        last = int(np.flatnonzero(np.isfinite(one["q"].values).all(axis=1))[-1])
        q, v = (np.array(one[name].values[last]) for name in ("q", "v"))
        return model, model.trusted_state(q, v, float(self.t[last]))

    def to_xarray(self) -> xarray.Dataset:
        """q and v over (t, robot, coordinate or independent), with the outcome of every robot and units.

        Where the results are in a file it is opened, and read as far as it is asked for.
        """
        import xarray

        if self.path is not None:
            return xarray.open_dataset(self.path, engine="h5netcdf")
        variables, coordinates, attributes = contents(self)
        data = {"q": (("t", "robot", "coordinate"), self.q), "v": (("t", "robot", "independent"), self.v), **variables}
        return xarray.Dataset(data, coords=coordinates, attrs=attributes)

    def _stored(self, name: str, values: FloatArray | None) -> FloatArray:
        if values is not None:
            return values
        with self.to_xarray() as dataset:
            return np.asarray(dataset[name].values)

    def __repr__(self) -> str:
        ends = ", ".join(f"{count} {outcome.name.lower()}" for outcome, count in self.counts().items())
        drift = f"{np.nanmax(self.energy_drift):.1e}" if np.isfinite(self.energy_drift).any() else "unknown"
        residual = f"{np.nanmax(self.residual):.1e}" if np.isfinite(self.residual).any() else "unknown"
        return (
            f"<BatchTrajectory of {len(self.outcome)} robots, {self.t[-1] - self.t[0]:.3g} s, "
            f"{self.statistics.steps} steps, energy drift {drift} J, closure {residual} m, {ends or 'nothing to do'}>"
        )


def contents(
    trajectory: BatchTrajectory,
) -> tuple[dict[str, tuple[Any, ...]], dict[str, tuple[Any, ...]], dict[str, Any]]:
    """Variables, coordinates and attributes of the data set, besides q and v: (dimensions, values, attributes) each."""
    model = trajectory.model
    codes = np.array([_OUTCOMES.index(outcome) for outcome in trajectory.outcome], dtype=np.int8)
    meanings = " ".join(outcome.name.lower() for outcome in _OUTCOMES)
    flags = {"flag_values": np.arange(len(_OUTCOMES), dtype=np.int8), "flag_meanings": meanings}
    variables: dict[str, tuple[Any, ...]] = {
        "outcome": ("robot", codes, flags),
        "ended": ("robot", trajectory.ended, {"units": "s"}),
        "accepted": ("robot", trajectory.accepted, {}),
        "refused": ("robot", trajectory.refused, {}),
        "residual": ("robot", trajectory.residual, {"units": "m", "long_name": "largest |Phi|"}),
        "energy_drift": ("robot", trajectory.energy_drift, {"units": "J"}),
    }
    coordinates: dict[str, tuple[Any, ...]] = {
        "t": ("t", trajectory.t, {"units": "s"}),
        "coordinate": ("coordinate", np.array(model.coordinates, dtype=object), {}),
        "independent": ("independent", np.array(model.independent, dtype=object), {}),
    }
    attributes: dict[str, Any] = {"mechanism": model.mechanism.name, "complete": 1}
    if trajectory.parameters.ndim == 2:
        variables["parameters"] = (("robot", "parameter"), trajectory.parameters, {})
        coordinates["parameter"] = ("parameter", np.array(tuple(model.parameters), dtype=object), {})
    else:
        attributes |= {f"parameter_{name}": x for name, x in zip(model.parameters, trajectory.parameters, strict=True)}
    attributes |= {f"statistics_{name}": value for name, value in vars(trajectory.statistics).items()}
    return variables, coordinates, attributes


def checked_times(t: object, start: float) -> FloatArray:
    """The times of the results, the first one the start.

    Raises:
        InputError: they do not increase, are not finite, or there is but one.
    """
    try:
        times = numbers(t, "time").astype(np.float64)
    except InputError:
        times = np.array(np.nan)
    if times.ndim == 0:
        times = np.array([start, float(times)])
    if times.ndim != 1 or len(times) < 2 or not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise InputError(
            f"t is the end time after the start {start:g} s, or increasing times of the results, the first one the "
            f"start; not {t!r:.80}"
        )
    return times
