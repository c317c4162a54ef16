"""nullbody simulate"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nullbody.cli.options import (
    Guess,
    Independent,
    Json,
    MechanismName,
    Out,
    Parameters,
    Rates,
    Values,
    assignments,
    complete,
    model_of,
)
from nullbody.cli.output import ROUNDING, complain, note, print_json, print_table
from nullbody.cli.reference import reference_of
from nullbody.errors import InputError, SimulationError

if TYPE_CHECKING:
    from nullbody.model import Model, State
    from nullbody.simulate import Trajectory

__all__ = ["EXAMPLES", "simulate"]

_HANGING = "y=-0.5,alpha1=-1.57,alpha2=-1.57,alpha3=-1.57"
EXAMPLES = (
    f"nullbody simulate three_prs --start s1=0.6,s2=0.6,s3=0.6 --guess {_HANGING} --rates s1=0.1 --until 2",
    "nullbody simulate three_prs --control computed-torque --reference paper --until 1 -o run.nc",
    "nullbody simulate three_prs --control feed-forward --reference s1=0.7,s2=0.5 --until 1 -o run.csv --json",
)


class Control(StrEnum):
    """How the inputs are found."""

    NONE = "none"
    FEED_FORWARD = "feed-forward"
    COMPUTED_TORQUE = "computed-torque"


Start = Annotated[
    Values,
    typer.Option(
        metavar="NAME=VALUE,...", help="Coordinates at the start. By default home, or where the paper's motion starts."
    ),
]
Until = Annotated[float, typer.Option(metavar="SECONDS", help="End time.")]
ControlKind = Annotated[Control, typer.Option(help="How the inputs are found.")]
Reference = Annotated[
    str, typer.Option(metavar="paper|NAME=VALUE,...", help="What --control follows: the paper's motion, or to a point.")
]
Gains = Annotated[
    Values,
    typer.Option(
        metavar="kp=VALUE,kd=VALUE",
        help="Of computed-torque, by default 100 and 20; of feed-forward, 0 and 0, which is open loop.",
    ),
]
Forces = Annotated[Values, typer.Option(metavar="NAME=VALUE,...", help="Constant inputs; those not named are 0.")]
Tolerance = Annotated[float, typer.Option(metavar="NUMBER", help="Relative tolerance of the local error.")]
Method = Annotated[
    str, typer.Option(metavar="explicit|stiff", help="Dormand-Prince 8(5,3), or Radau IIA for stiff motions.")
]
Keep = Annotated[bool, typer.Option("--keep", help="Keep the independent coordinates: end where they become singular.")]
Samples = Annotated[
    int | None, typer.Option(min=2, metavar="COUNT", help="Number of evenly spaced samples; by default all steps.")
]


def simulate(  # noqa: PLR0913, one parameter for each option
    mechanism: MechanismName,
    start: Start = None,
    guess: Guess = None,
    rates: Rates = None,
    until: Until = 1.0,
    control: ControlKind = Control.NONE,
    reference: Reference = "paper",
    gains: Gains = None,
    forces: Forces = None,
    rtol: Tolerance = 1e-10,
    samples: Samples = None,
    method: Method = "explicit",
    keep: Keep = False,
    parameters: Parameters = None,
    independent: Independent = None,
    out: Out = None,
    as_json: Json = False,
) -> int:
    """Simulate a motion and say how it ended.

    The file of --out ends in .nc or .csv. The exit code is 1 where the end time is not reached; what was reached
    is printed and written all the same.
    """
    from nullbody.simulate import simulate as motion

    write = None if out is None else _writer(out)
    model = model_of(mechanism, independent, parameters)
    state = _start(model, assignments(start, "--start"), assignments(rates, "--rates"), guess, control, reference)
    inputs = _inputs(
        model, state, control, reference, assignments(gains, "--gains"), assignments(forces, "--forces"), until
    )
    failure: SimulationError | None = None
    try:
        trajectory = motion(model, state, until, u=inputs, rtol=rtol, samples=samples, method=method, switch=not keep)
    except SimulationError as error:
        trajectory, failure = error.trajectory, error
    if write is not None:
        write(trajectory)
    _show(trajectory, until, out, as_json)
    return 0 if failure is None else complain(failure, 1)


def _writer(out: Path) -> Callable[[Trajectory], None]:
    """What writes the file, checked before the simulation."""
    from nullbody.export import check_target, write_csv, write_netcdf

    write = write_csv if check_target(out, ".nc", ".csv").suffix.lower() == ".csv" else write_netcdf
    return lambda trajectory: write(trajectory, out)


def _start(
    model: Model, known: dict[str, float], rates: dict[str, float], guess: Values, control: Control, reference: str
) -> State:
    """The first state: the given one; where none is given, the start of the paper's reference, or home."""
    from nullbody.kinematics import assemble

    v = complete(rates, model.independent, "independent rate")
    if control is not Control.NONE and reference == "paper" and not known and not rates:
        demand = reference_of(reference, model, None, 1.0)(0.0)
        known = dict(zip(model.independent, demand.position.tolist(), strict=True))
        v = dict(zip(model.independent, demand.rate.tolist(), strict=True))
    return assemble(model, known, v=v, guess=assignments(guess, "--guess") or None)


def _inputs(
    model: Model,
    state: State,
    control: Control,
    reference: str,
    gains: dict[str, float],
    forces: dict[str, float],
    until: float,
) -> Callable[[float, State], object] | Mapping[str, float]:
    """Constant inputs, or a controller."""
    from nullbody.control import ComputedTorque, FeedForward, desired_motion

    if control is Control.NONE:
        if gains:
            raise InputError("--gains are for feed-forward and computed-torque: name one of them with --control")
        return complete(forces, model.inputs, "input")
    if forces:
        raise InputError(f"--forces are for --control none; {control.value} finds the inputs itself")
    complete(gains, ("kp", "kd"), "gain")
    followed = reference_of(reference, model, state, until)
    if control is Control.COMPUTED_TORQUE:
        return ComputedTorque(model, followed, **gains)
    return FeedForward(desired_motion(model, followed, until, guess=state), **gains)


def _show(trajectory: Trajectory, until: float, out: Path | None, as_json: bool) -> None:
    """How it ended, its balances, and the first and last sample."""
    model = trajectory.model
    values = {name: trajectory[name] for name in model.coordinates}
    values |= {f"{name}_dot": trajectory.v[:, k] for k, name in enumerate(model.independent)}
    if as_json:
        entries: dict[str, Any] = {
            "mechanism": model.mechanism.name,
            "parameters": model.parameters,
            "until": until,
            "reached": trajectory.t[-1],
            "outcome": trajectory.outcome.name,
            "samples": len(trajectory.t),
            "start": {name: column[0] for name, column in values.items()},
            "end": {name: column[-1] for name, column in values.items()},
            "statistics": asdict(trajectory.statistics),
            "file": out,
        }
        print_json(entries)
        return
    statistics = trajectory.statistics
    print(f"{model.mechanism.name}: {trajectory.outcome.name}, {trajectory.outcome.value}")
    print(f"  reached       {trajectory.t[-1]:.6g} s of {until:g} s, {len(trajectory.t)} samples")
    print(f"  energy drift  {statistics.energy_drift:.1e} J")
    print(f"  closure       {statistics.residual:.1e} m")
    print(
        f"  cost          {statistics.steps} steps, {statistics.evaluations} evaluations, {statistics.seconds:.2g} s\n"
    )
    units = dict(model.mechanism.units)
    units |= {f"{name}_dot": f"{units[name]}/s" for name in model.independent}
    rows = [(name, float(column[0]), float(column[-1]), units[name]) for name, column in values.items()]
    print_table(("name", "start", "end", "unit"), rows, smallest=ROUNDING)
    if out is not None:
        note(f"written to {out}")
