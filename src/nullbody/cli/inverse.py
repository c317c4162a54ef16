"""nullbody inverse"""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nullbody.cli.options import (
    Guess,
    Independent,
    Json,
    MechanismName,
    Parameters,
    Rates,
    Values,
    assignments,
    complete,
    model_of,
)
from nullbody.cli.output import ROUNDING, print_json, print_table
from nullbody.errors import InputError

if TYPE_CHECKING:
    from nullbody.model import Model, State

__all__ = ["EXAMPLES", "inverse"]

EXAMPLES = (
    "nullbody inverse three_prs",
    "nullbody inverse three_prs --at s1=0.6,s2=0.6,s3=0.6 --rates s1=0.1 --accelerations s2=-0.5",
    "nullbody inverse three_prs --pose y=0.45,psi=0.05,phi=0",
)

At = Annotated[Values, typer.Option(metavar="NAME=VALUE,...", help="Forces in one state, given by coordinates.")]
Accelerations = Annotated[
    Values, typer.Option(metavar="NAME=VALUE,...", help="Accelerations, with --at; those not named are 0.")
]
Pose = Annotated[
    Values, typer.Option(metavar="NAME=VALUE,...", help="Inverse kinematics: coordinates of the end effector.")
]
Until = Annotated[float, typer.Option(metavar="SECONDS", help="End of the reference.")]
Samples = Annotated[int, typer.Option(min=2, metavar="COUNT", help="Number of times along the reference.")]


def inverse(  # noqa: PLR0913, one parameter for each option
    mechanism: MechanismName,
    at: At = None,
    rates: Rates = None,
    accelerations: Accelerations = None,
    pose: Pose = None,
    guess: Guess = None,
    until: Until = 2.0,
    samples: Samples = 11,
    parameters: Parameters = None,
    independent: Independent = None,
    as_json: Json = False,
) -> None:
    """Inverse dynamics and inverse kinematics.

    Without --at and --pose: the inputs that make the mechanism follow the paper's reference. With --at: the inputs
    and the loops' reactions for given accelerations in one state. With --pose: all coordinates for a pose of the end
    effector, and how far they are from a singularity (0 singular, 1 best).
    """
    given_rates, given_accelerations = assignments(rates, "--rates"), assignments(accelerations, "--accelerations")
    if at and pose:
        raise InputError("give either --at or --pose, not both")
    if not at and (given_rates or given_accelerations):
        raise InputError("--rates and --accelerations belong to a state: give it with --at")
    model = model_of(mechanism, independent, parameters)
    near = assignments(guess, "--guess") or None
    if pose:
        _pose(model, assignments(pose, "--pose"), near, as_json)
    elif at:
        from nullbody.kinematics import assemble

        v = complete(given_rates, model.independent, "independent rate")
        state = assemble(model, assignments(at, "--at"), v=v, guess=near)
        _at(model, state, complete(given_accelerations, model.independent, "independent acceleration"), as_json)
    else:
        _along_reference(model, until, samples, near, as_json)


def _pose(model: Model, pose: dict[str, float], near: dict[str, float] | None, as_json: bool) -> None:
    from nullbody.kinematics import inverse_kinematics, singularity

    state = inverse_kinematics(model, pose, guess=near)
    measures = asdict(singularity(model, state))
    if as_json:
        print_json({"coordinates": state.positions, "singularity": measures})
        return
    _print_coordinates(model, state)
    print_table(("singularity", "measure"), measures.items())


def _at(model: Model, state: State, v_dot: dict[str, float], as_json: bool) -> None:
    u = model.inverse_dynamics(state, v_dot)
    inputs = dict(zip(model.inputs, u.tolist(), strict=True))
    reactions = dict(zip(model.labels, model.reactions(state, u).tolist(), strict=True))
    if as_json:
        entries = {"coordinates": state.positions, "rates": state.rates, "accelerations": v_dot}
        print_json({**entries, "inputs": inputs, "reactions": reactions})
        return
    _print_coordinates(model, state)
    print_table(("input", "value"), inputs.items(), smallest=ROUNDING)
    print_table(("reaction", "lambda"), reactions.items(), smallest=ROUNDING)


def _along_reference(model: Model, until: float, samples: int, near: dict[str, float] | None, as_json: bool) -> None:
    import numpy as np

    from nullbody.cli.reference import reference_of
    from nullbody.control import desired_motion
    from nullbody.kinematics import assemble

    reference = reference_of("paper", model, None, until)
    start = dict(zip(model.independent, reference(0.0).position.tolist(), strict=True))
    desired = desired_motion(model, reference, until, guess=assemble(model, start, guess=near))
    rows: list[dict[str, Any]] = []
    for t in np.linspace(0.0, until, samples).tolist():
        position = dict(zip(model.independent, reference(t).position.tolist(), strict=True))
        rows.append({"t": t, **position, **dict(zip(model.inputs, desired.inputs(t).tolist(), strict=True))})
    if as_json:
        print_json({name: [row[name] for row in rows] for name in rows[0]})
        return
    units = [("s" if name == "t" else _unit(model, name)) for name in rows[0]]
    columns = [f"{name} [{unit}]" for name, unit in zip(rows[0], units, strict=True)]
    print_table(columns, [tuple(row.values()) for row in rows], smallest=ROUNDING)


def _unit(model: Model, name: str) -> str:
    """The unit of a coordinate or an input."""
    units = model.mechanism.units
    if name in units:
        return units[name]
    coordinate = dict(zip(model.inputs, model.mechanism.actuated, strict=True))[name]
    return "N" if units[coordinate] == "m" else "N m"


def _print_coordinates(model: Model, state: State) -> None:
    units = model.mechanism.units
    print_table(
        ("coordinate", "value", "unit"), [(n, x, units[n]) for n, x in state.positions.items()], smallest=ROUNDING
    )
