"""write_fmu: a model as a functional mock-up unit, for other simulators."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from nullbody.equations import Equations, derive
from nullbody.errors import InputError, NullbodyError, UnknownName
from nullbody.export.fmu.binary import PLATFORMS, compiled, compiler, folder, here
from nullbody.export.fmu.description import build_description, model_description
from nullbody.export.fmu.page import page
from nullbody.export.fmu.source import sources
from nullbody.export.fmu.variables import Unit
from nullbody.export.target import check_target, replacement
from nullbody.kinematics import assemble
from nullbody.model import Model, State, build

__all__ = ["WrittenFmu", "write_fmu"]

_MOMENT = (1980, 1, 1, 0, 0, 0)  # of all files, so that the same model gives the same bytes


@dataclass(frozen=True)
class WrittenFmu:
    """What a unit that has been written holds.

    Attributes:
        path: the file.
        platforms: those that it has binaries for.
        note: what the reader should know where there is none; empty otherwise.
    """

    path: Path
    platforms: tuple[str, ...]
    note: str


def write_fmu(
    model: Model | Equations,
    path: str | os.PathLike[str],
    *,
    fmi: int = 2,
    start: State | None = None,
    charts: Sequence[Sequence[str]] = (),
    reactions: bool = True,
    platforms: Sequence[str] | None = None,
) -> WrittenFmu:
    """Write a unit for model exchange and co-simulation, FMI 2.0 or 3.0, with its C sources.

        x = (q, v):   q' = N v + beta,   Mr v' + hr = Br u,   Phi(q, t) = 0

    Inputs u; outputs q, q', q'', power, energies, reactions, |Phi|; parameters and start values are set before the
    simulation, the loops are then closed again. At a singularity of the independent coordinates the unit ends, by
    name; co-simulation goes on in the independent coordinates of another chart, where there is a better one.

    Args:
        model: from `build`, or equations from `derive` with the mechanism's own parameter values. Parameters that
            are formulas of others follow them in the unit too, but for those that the model gives a value.
        path: ends in .fmu; a file that is there is replaced.
        fmi: 2 or 3.
        start: where it begins; the mechanism's home at rest by default.
        charts: names of other independent coordinates that co-simulation may change to.
        reactions: whether the forces of the closures are outputs.
        platforms: what to compile for, of linux64, win64, darwin64, aarch64-linux, aarch64-darwin; others than this
            machine's need the package ziglang. By default this machine's, or the sources alone where it has no
            compiler; an empty list for the sources alone.

    Returns:
        The platforms that are in, and a note where there is none.

    Raises:
        InputError, UnknownName: no model, no such version or platform, or a start of another model.
        AssemblyError: there is no start, and the loops do not close at home.
        OutputError: it cannot be written or compiled; what was there before is untouched.
    """
    target = check_target(path, ".fmu")
    if fmi not in (2, 3) or isinstance(fmi, bool):
        raise InputError(f"fmi must be 2 or 3, not {fmi!r}")
    wanted = _wanted(platforms)
    unit = _unit(model, start, reactions, charts)
    parts, token = sources(unit, fmi)
    to_compile = ["kernels.c", f"fmi{fmi}.c"]
    members: dict[str, bytes] = {
        "modelDescription.xml": model_description(unit, token, fmi, to_compile),
        "documentation/index.html": page(unit).encode(),
        **{f"sources/{name}": text.encode() for name, text in parts.items()},
    }
    if fmi == 3:
        members["sources/buildDescription.xml"] = build_description(unit, to_compile)
    members |= _binaries(unit, parts, to_compile, wanted, fmi)
    with replacement(path, ".fmu") as draft, zipfile.ZipFile(draft, "x", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name, _MOMENT)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return WrittenFmu(target, wanted, _note(platforms, wanted))


def _wanted(platforms: Sequence[str] | None) -> tuple[str, ...]:
    """The platforms to compile for, checked before any work is done."""
    if platforms is None:
        own = here()
        return (own,) if own is not None and compiler(own) is not None else ()
    if not isinstance(platforms, list | tuple) or not all(isinstance(name, str) for name in platforms):
        raise InputError(f"platforms must be a list of names, such as ['linux64'], not {platforms!r}")
    for name in platforms:
        if name not in PLATFORMS:
            raise UnknownName("platform", name, PLATFORMS)
        if compiler(name) is None:
            raise InputError(
                f'there is no compiler for {name} here: install the package ziglang (pip install "nullbody[native]"), '
                "or leave the platform out; the sources are in the unit in any case"
            )
    return tuple(dict.fromkeys(platforms))


def _note(platforms: Sequence[str] | None, wanted: Sequence[str]) -> str:
    if wanted or platforms is not None:
        return ""
    return (
        "no C compiler was found: the unit holds its sources alone, and a simulator that takes it must compile them. "
        'Install gcc or clang, name one in CC, or install the package ziglang (pip install "nullbody[native]")'
    )


def _unit(model: object, start: State | None, reactions: bool, charts: Sequence[Sequence[str]]) -> Unit:
    if isinstance(model, Equations):
        model = build(model)
    if not isinstance(model, Model):
        raise InputError(f"write_fmu takes a Model from build or Equations from derive, not {type(model).__name__}")
    if not isinstance(charts, list | tuple) or not all(isinstance(names, list | tuple) for names in charts):
        raise InputError(f"charts are lists of names, such as [('y', 'psi', 'phi')], not {charts!r}")
    if start is None:
        state = assemble(model, {})
    elif isinstance(start, State):
        state = model.own(start)
    else:
        raise InputError(f"start must be a State from assemble(model, {{...}}), not {start!r}")
    try:
        model.null_space(state)
    except NullbodyError as error:
        raise InputError(f"the unit cannot begin in this state: {error}") from error
    found = tuple(_written_in(model, tuple(names)) for names in (model.independent, *charts))
    return Unit(found[0], model, state, reactions, found)


def _written_in(model: Model, names: tuple[str, ...]) -> Equations:
    """The equations in some independent coordinates as their only basis: nothing else becomes singular."""
    return derive(model.mechanism, names, rows=model.labels, basis=names)


def _binaries(
    unit: Unit, parts: dict[str, str], to_compile: Sequence[str], wanted: Sequence[str], fmi: int
) -> dict[str, bytes]:
    """The compiled libraries by their places in the unit."""
    found: dict[str, bytes] = {}
    if not wanted:
        return found
    with tempfile.TemporaryDirectory(prefix="nullbody-fmu-") as place:
        for name, text in parts.items():
            (Path(place) / name).write_text(text, encoding="utf-8")
        for name in wanted:
            library = compiled(Path(place), to_compile, unit.identifier, name)
            if library is not None:
                found[f"{folder(name, fmi)}/{unit.identifier}{PLATFORMS[name][2]}"] = library
    return found
