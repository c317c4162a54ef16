"""Section: any mechanism. The whole catalog drawn, counted, timed, and held against independent engines."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nullbody.catalog import ENTRIES, MODELS, Entry
from nullbody.equations import Equations, derive
from nullbody.model import Model, State, build
from nullbody.report.album import picture_pose
from nullbody.report.case import Settings
from nullbody.report.draw import draw_into
from nullbody.report.figure import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, drawing, svg
from nullbody.report.section import Check, Figure, Part, Section, Table, Text, number
from nullbody.verify import EngineResult, compare

__all__ = ["Catalogued", "catalog_times", "catalogued", "mechanisms"]

_TOLERANCE = 1e-10  # relative, of accelerations, forces and reactions
_CLOSED = 1e-13  # m, after assembly
_STATES = 10  # for each mechanism and engine, at most
_ACROSS = 3  # pictures side by side
_FLOOR = 1e-18  # what a difference of exactly zero is drawn as
_COLOURS = {"multipliers": BLUE, "mujoco": ORANGE, "pinocchio": PURPLE}
_MARKERS = {"forward_dynamics": "o", "inverse_dynamics": "s", "reactions": "^"}
_WORDS = {"forward_dynamics": "accelerations", "inverse_dynamics": "forces", "reactions": "reactions"}

_PROGRAM = """
import json, time
from nullbody.catalog import ENTRIES, MODELS
from nullbody.equations import derive
from nullbody.model import build
build(derive(MODELS["a01_pendulum"](L=2.0)))
found = {}
for entry in ENTRIES.values():
    mechanism = MODELS[entry.name](**entry.arguments)
    begin = time.perf_counter()
    equations = derive(mechanism)
    derived = time.perf_counter()
    build(equations)
    found[entry.name] = derived - begin, time.perf_counter() - derived
print(json.dumps(found))
"""

#: Seconds to derive and to build, by mechanism.
Times = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Catalogued:
    """A mechanism of the catalog with what was found of it.

    Attributes:
        entry: what the catalog says.
        equations, model: of its own parameters.
        pose: the state of the picture.
        gap: largest |Phi| there [m].
        engines: the comparison with each engine, by name.
    """

    entry: Entry
    equations: Equations
    model: Model
    pose: State
    gap: float
    engines: Mapping[str, EngineResult]

    def worst(self, engine: str) -> float | None:
        """Largest relative error of all quantities against an engine; nothing where it did not run."""
        sizes = [found.max_rel_error for found in self.engines[engine].quantities.values()]
        return float(np.max(sizes)) if sizes else None


def catalog_times() -> Times:
    """Seconds to derive and to build every mechanism, in a new process with an empty kernel cache."""
    with tempfile.TemporaryDirectory(prefix="nullbody-report-") as folder:
        environment = {**os.environ, "NULLBODY_CACHE": folder}
        command = [sys.executable, "-c", _PROGRAM]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=120)
    return {name: (derived, built) for name, (derived, built) in json.loads(done.stdout).items()}


def catalogued(entry: Entry, engines: tuple[str, ...], states: int) -> Catalogued:
    """Derive, build, assemble and compare one mechanism."""
    equations = derive(MODELS[entry.name](**entry.arguments))
    model = build(equations)
    pose = picture_pose(model, entry)
    gap = float(np.abs(model.residual(pose.q)).max(initial=0.0))
    found = compare(model, engines=engines, states=states, missing="skip")
    return Catalogued(entry, equations, model, pose, gap, {result.name: result for result in found.engines})


def mechanisms(settings: Settings, times: Times) -> Section:
    """The catalog: pictures, mobility with its reason, sizes and times, and agreement with the engines."""
    names = ("multipliers", *settings.engines)
    states = min(settings.states, _STATES)
    found = [catalogued(entry, names, states) for entry in ENTRIES.values()]
    parts: list[Part] = [
        Text(
            "Nothing in the package knows the 3-PRS. The same steps take any mechanism of rigid bodies with loops: "
            "robots, linkages, redundant closures, Euler parameters, blades and rolling wheels. These are the "
            f"{len(found)} of the catalog. A mechanism of your own is written in the same way, with a builder or a "
            "model file."
        ),
        Figure(
            _gallery(found),
            "The catalog, drawn by the package from bodies and joints alone, each in an assembled pose. Bodies of one "
            "leg have one colour, white bars are axes of hinges, white circles pins and balls, black arrows the "
            "inputs. See that no picture has a gap: the loops are closed to rounding.",
        ),
        _count_table(found),
        _time_table(found, times),
        Text(
            f"Each was compared at {states} random states on its constraint manifold, with random rates and inputs: "
            "accelerations, inputs of inverse dynamics, and reactions. The engines build their own models from bodies, "
            "joints and loops: multipliers in full coordinates (six velocities for each body, nothing symbolic), "
            "MuJoCo, Pinocchio."
        ),
        Figure(
            _chart(found, names),
            "Largest relative error against each engine, logarithmic; circles: accelerations, squares: forces, "
            "triangles: reactions; the dashed line is the limit. See that all of them lie at rounding, four decades "
            "below the limit, for redundant mechanisms (Bricard, all plane ones) and nonholonomic ones as well. Points "
            "far to the left are zeros, or small against the forces that cancel in them.",
        ),
    ]
    return Section("mechanisms", "Any mechanism", tuple(parts), _checks(found, names), _numbers(found, times, names))


def _count_table(found: list[Catalogued]) -> Table:
    rows = []
    for made in found:
        mobility = made.equations.mobility
        rows.append(
            (
                made.entry.title,
                str(mobility.nq),
                str(mobility.rows),
                str(mobility.rank),
                str(mobility.nv),
                str(mobility.gruebler),
                _reason(made),
            )
        )
    return Table(
        ("mechanism", ">q", ">equations", ">independent", ">mobility", ">by counting", "why"),
        tuple(rows),
        "Mobility as the package finds it, coordinates minus independent equations, beside what counting alone gives "
        "(Grübler, Kutzbach), and the equations that it names as repeating others.",
    )


def _reason(made: Catalogued) -> str:
    """What the catalog says, and the names of the rows that were found to be redundant."""
    mobility = made.equations.mobility
    reasons = [made.entry.mobility]
    if mobility.always:
        reasons.append(f"found to repeat others: {', '.join(mobility.always)}")
    if mobility.closed:
        reasons.append(f"found to repeat others where the loops are closed: {', '.join(mobility.closed)}")
    return "; ".join(reasons)


def _time_table(found: list[Catalogued], times: Times) -> Table:
    rows = []
    for made in found:
        derived, built = times[made.entry.name]
        errors = (number(made.worst(name)) for name in made.engines)
        operations = made.equations.routine_operations("forward_dynamics").arithmetic
        loops = len(made.model.mechanism.loops)
        sizes = (str(loops), str(operations), f"{1e3 * derived:.0f}", f"{1e3 * built:.0f}", number(made.gap))
        rows.append((made.entry.title, *sizes, *errors))
    head = ("mechanism", ">loops", ">operations", ">derive [ms]", ">build [ms]", ">gap [m]")
    return Table(
        (*head, *(f">{name}" for name in found[0].engines)),
        tuple(rows),
        "Loops: joints that close one; the pendulum, the sleigh and the disc have equations of their own instead. "
        "Operations: arithmetic of forward dynamics, q'' and all that guards it. Derive and build: one new process, "
        "every kernel compiled. Gap: largest open closure after assembly. Last columns: largest relative error of "
        "accelerations, forces and reactions against each engine.",
    )


def _checks(found: list[Catalogued], names: tuple[str, ...]) -> tuple[Check, ...]:
    known = all(made.equations.mobility.nv == made.entry.degrees_of_freedom for made in found)
    own = [
        Check.at_most(
            f"{made.entry.title}: against multipliers in full coordinates, relative",
            made.worst("multipliers"),
            _TOLERANCE,
            "",
            "required",
        )
        for made in found
    ]
    return (
        Check.holds("All mechanisms: mobility as in the literature", known, "literature"),
        Check.at_most("All mechanisms: gap in the loops after assembly", _gap(found), _CLOSED, "m", "rounding"),
        *own,
        *(
            Check.at_most(f"All mechanisms: against {name}, relative", _worst(found, name), _TOLERANCE, "", "required")
            for name in names[1:]
        ),
    )


def _gap(found: list[Catalogued]) -> float:
    return max(made.gap for made in found)


def _worst(found: list[Catalogued], engine: str) -> float | None:
    """Over the mechanisms that the engine can have."""
    sizes = [size for made in found if (size := made.worst(engine)) is not None]
    return float(np.max(sizes)) if sizes else None


def _numbers(found: list[Catalogued], times: Times, names: tuple[str, ...]) -> dict[str, float | None]:
    """Entries of summary.json."""
    numbers: dict[str, float | None] = {"catalog.gap": _gap(found)}
    for name in names:
        numbers[f"catalog.max_rel_error.{name}"] = _worst(found, name)
    for made in found:
        key = f"catalog.{made.entry.name}"
        numbers[f"{key}.operations"] = made.equations.routine_operations("forward_dynamics").arithmetic
        numbers[f"{key}.derive_seconds"], numbers[f"{key}.build_seconds"] = times[made.entry.name]
    return numbers


def _gallery(found: list[Catalogued]) -> str:
    rows = -(-len(found) // _ACROSS)
    with drawing(13.0, 3.15 * rows) as canvas:
        places = canvas.subplots(rows, _ACROSS).flat
        for axes, made in zip(places, found, strict=False):
            azimuth, elevation = made.entry.view
            model, q = made.model, made.pose.positions
            draw_into(axes, model.mechanism, model.parameters, q, azimuth=azimuth, elevation=elevation)
            axes.set_title(made.entry.title, loc="center", fontsize=12)
        for axes in list(canvas.axes)[len(found) :]:
            axes.axis("off")
        return svg(canvas)


def _chart(found: list[Catalogued], names: tuple[str, ...]) -> str:
    """One line for each mechanism, one colour for each engine, one marker for each quantity."""
    from matplotlib.lines import Line2D

    with drawing(9.0, 0.27 * len(found) + 1.2) as canvas:
        axes = canvas.subplots()
        for place, made in enumerate(reversed(found)):
            for k, name in enumerate(names):
                for quantity, result in made.engines[name].quantities.items():
                    size = max(result.max_rel_error, _FLOOR)
                    height = place + 0.22 * (1 - k)
                    axes.plot(
                        size, height, marker=_MARKERS[quantity], color=_COLOURS.get(name, GREEN), ms=4.5, alpha=0.85
                    )
        axes.axvline(_TOLERANCE, color=BLACK, ls="--", lw=1)
        axes.set_xscale("log")
        axes.set_xlim(_FLOOR / 2, 1e-8)
        axes.set_ylim(-0.7, len(found) - 0.3)
        axes.set_yticks(range(len(found)), [made.entry.title for made in reversed(found)])
        axes.set_xlabel("relative error")
        handles = [Line2D([], [], color=_COLOURS.get(name, GREEN), lw=4, label=name) for name in names]
        handles += [
            Line2D([], [], color=GREY, ls="", marker=_MARKERS[key], label=words) for key, words in _WORDS.items()
        ]
        axes.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.35, 1.0), ncols=len(handles))
        return svg(canvas)
