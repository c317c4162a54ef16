"""nullbody export fmu"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

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
    names,
)
from nullbody.cli.output import note, print_json

__all__ = ["EXAMPLES", "fmu"]

EXAMPLES = (
    "nullbody export fmu three_prs -o three_prs.fmu",
    "nullbody export fmu four_bar --set crank=2.2 --fmi 3 --sources-only -o four_bar.fmu",
)

_Start = Annotated[
    Values, typer.Option(metavar="NAME=VALUE,...", help="Coordinates of the start; the mechanism's home by default.")
]
_Fmi = Annotated[int, typer.Option(metavar="2|3", help="Version of FMI.")]
_Platforms = Annotated[
    Values,
    typer.Option(
        metavar="NAME,...",
        help="Compile for linux64, win64, darwin64, aarch64-linux, aarch64-darwin; this machine by default.",
    ),
]
_Sources = Annotated[bool, typer.Option("--sources-only", help="Compile nothing: the unit holds its C sources alone.")]
_Charts = Annotated[
    Values,
    typer.Option("--chart", metavar="NAME,...", help="Other independent coordinates for co-simulation; repeatable."),
]
_Reactions = Annotated[bool, typer.Option("--no-reactions", help="Without the forces of the closures as outputs.")]
_File = Annotated[Path | None, typer.Option("--out", "-o", metavar="FILE", help="The unit; MECHANISM.fmu by default.")]


def fmu(  # noqa: PLR0913, one parameter for each option
    mechanism: MechanismName,
    out: _File = None,
    fmi: _Fmi = 2,
    independent: Independent = None,
    parameters: Parameters = None,
    start: _Start = None,
    guess: Guess = None,
    rates: Rates = None,
    platforms: _Platforms = None,
    charts: _Charts = None,
    sources_only: _Sources = False,
    no_reactions: _Reactions = False,
    as_json: Json = False,
) -> None:
    """Write a functional mock-up unit for other simulators: model exchange and co-simulation, sources and binary."""
    from nullbody.errors import InputError
    from nullbody.export import write_fmu
    from nullbody.export.target import check_target
    from nullbody.kinematics import assemble

    if platforms and sources_only:
        raise InputError("--platforms and --sources-only exclude each other: leave one of them out")
    target = check_target(Path(f"{Path(mechanism).stem}.fmu") if out is None else out, ".fmu")
    model = model_of(mechanism, independent, parameters)
    v = complete(assignments(rates, "--rates"), model.independent, "independent rate")
    state = assemble(model, assignments(start, "--start"), v=v, guess=assignments(guess, "--guess") or None)
    wanted: Any = [] if sources_only else names(platforms) or None
    others = [names([chart]) for chart in charts or ()]
    written = write_fmu(
        model, target, fmi=fmi, start=state, charts=others, reactions=not no_reactions, platforms=wanted
    )
    entries = {
        "mechanism": model.mechanism.name,
        "fmi": fmi,
        "file": written.path,
        "platforms": written.platforms,
        "states": len(model.coordinates) + len(model.independent),
        "inputs": model.inputs,
    }
    if as_json:
        print_json(entries)
    else:
        within = ", ".join(written.platforms) or "no binaries"
        print(f"{written.path}: FMI {fmi}.0, {entries['states']} states, C sources, {within}")
    if written.note:
        note(written.note)
