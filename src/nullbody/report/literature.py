"""Section: published benchmarks, each simulated as it was published and held against its reference numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.catalog import ENTRIES, MODELS, starts
from nullbody.equations import derive
from nullbody.kinematics import consistent
from nullbody.model import build
from nullbody.report.curve import Error, Panel, Series, draw_panel
from nullbody.report.figure import BLUE, ORANGE, drawing, svg
from nullbody.report.reference import PUBLISHED, Published, reference
from nullbody.report.section import Check, Figure, Section, Table, Text, number
from nullbody.simulate import Trajectory, simulate
from nullbody.typing import FloatArray

__all__ = ["Repeated", "literature", "repeated"]

_RTOL = 1e-12  # unless a motion asks for another
_FINE = 24  # samples of a curve between two reference numbers
_ENERGY = 0.1  # J, what A02 allows
_CLOSED = 2e-13  # m; across flat poses the interpolant is taken as it is
_SYMBOLS = {
    "alpha": r"$\alpha$",
    "beta": r"$\beta$",
    "epsilon": r"$\epsilon$",
    "phi": r"$\phi$",
    "theta": r"$\theta$",
    "B0_x": "$x$",
    "B0_y": "$y$",
    "P3_x": "$x$",
    "P3_y": "$y$",
    "P3_z": "$z$",
    "x2": "$x_2$",
    "y2": "$y_2$",
    "n_z": "$n_z$",
}


@dataclass(frozen=True, eq=False)
class Repeated:
    """A published motion, simulated.

    Attributes:
        given: what was published.
        found: the simulation; every so many-th sample is at a time of the reference.
        positions, rates: largest error over all compared columns, at the reference's times.
        drawn: the drawn columns over all samples and the same of the reference.
    """

    given: Published
    found: Trajectory
    positions: FloatArray
    rates: FloatArray
    drawn: tuple[FloatArray, FloatArray]

    @property
    def times(self) -> FloatArray:
        """The reference's times [s]."""
        return self.found.t[::_FINE]


def repeated(given: Published) -> Repeated:
    """Simulate a published motion from its start in the catalog to the last time of its reference."""
    wanted = reference(given.mechanism, given.motion)
    start = starts(given.mechanism, **given.arguments)[given.start]
    model = build(derive(MODELS[given.mechanism](**given.arguments))).replace(**start.mechanism.values())
    knots = np.arange(len(wanted["t"]))
    samples = np.interp(np.arange(_FINE * knots[-1] + 1) / _FINE, knots, wanted["t"])
    state = consistent(model, start.q, start.q_dot).state
    options = {"rtol": _RTOL, **given.options}
    found = simulate(model, state, float(samples[-1]), samples=samples, progress=False, **options)
    positions, rates = given.seen(found)

    def error(columns: dict[str, FloatArray]) -> FloatArray:
        worst: FloatArray = np.max([np.abs(v[::_FINE] - wanted[name]) for name, v in columns.items()], axis=0)
        return worst

    ours, theirs = [positions[c] for c in given.drawn], [wanted[c] for c in given.drawn]
    return Repeated(given, found, error(positions), error(rates), (np.array(ours).T, np.array(theirs).T))


def literature() -> Section:
    """The published benchmarks of multibody codes."""
    runs = [repeated(given) for given in PUBLISHED]
    numbers: dict[str, float] = {}
    for run in runs:
        key = f"published.{run.given.mechanism}.{run.given.motion}"
        numbers[f"{key}.position_error"] = float(run.positions.max())
        numbers[f"{key}.rate_error"] = float(run.rates.max())
        numbers[f"{key}.energy_drift"] = run.found.statistics.energy_drift
        numbers[f"{key}.seconds"] = run.found.statistics.seconds
    return Section(
        "published",
        "Published benchmarks",
        (
            Text(
                "Problems that multibody codes have been compared on for years: the IFToMM library A01 to A05, the "
                "Test Set for IVP Solvers, a toolbox's four-bars, and nonholonomic motions with known solutions. Each "
                "starts from <code>catalog.starts(name)</code> and runs for as long as its reference. The reference "
                "numbers lie in the package; they are exact, or were computed with 34 digits in full coordinates with "
                "multipliers, and are good to far below rounding. They hold more digits than the publications print: "
                "those of the Test Set for Andrews' mechanism are wrong beyond the tenth."
            ),
            _table(runs),
            Figure(
                _chart([run for run in runs if run.given.drawn]),
                "One motion of each benchmark. Lines: this package; circles: the reference numbers; beneath, on a "
                "logarithmic axis, the largest error of all compared positions (blue) and rates (orange). See every "
                "circle on its line. See also how errors grow: hardly for the stiff governor A05, whose damping "
                "forgets them, and for the redundant Bricard, most for the four-bars of A02, which pass 20 flat poses.",
            ),
        ),
        _checks(runs),
        numbers,
    )


def _table(runs: list[Repeated]) -> Table:
    rows = []
    for run in runs:
        kept = run.found.statistics
        rows.append(
            (
                run.given.title,
                f"{run.found.t[-1]:g}",
                run.given.asked,
                number(float(run.positions.max())),
                number(float(run.rates.max())),
                number(kept.energy_drift),
                number(kept.residual),
                str(kept.steps),
                str(kept.switches),
                str(kept.crossings),
                f"{kept.seconds:.2f}",
            )
        )
    head = ("motion", ">time [s]", "asked for", ">position error", ">rate error", ">energy error [J]")
    return Table(
        (*head, ">open loops [m]", ">steps", ">changes", ">passed", ">computed in [s]"),
        tuple(rows),
        "Errors are the largest over all compared columns and times [m, rad, and per second]. Asked for: the accuracy "
        "that the publication wants. Changes: of the independent coordinates. Passed: configuration singularities. All "
        "at rtol 1e-12, A02 and A05 at 1e-9, A05 by the stiff method. Sources: "
        + "; ".join(dict.fromkeys(ENTRIES[run.given.mechanism].source for run in runs))
        + ".",
    )


def _checks(runs: list[Repeated]) -> tuple[Check, ...]:
    checks = []
    for run in runs:
        what, limit = f"{run.given.title}: largest position error", run.given.digits[0]
        checks.append(Check.at_most(what, float(run.positions.max()), limit, run.given.unit, "reference"))
    rows = [run.found.statistics for run in runs if run.given.mechanism == "n_four_bar"]
    share = max(float(run.rates.max()) / run.given.digits[1] for run in runs)
    drift, passed = max(kept.energy_drift for kept in rows), min(kept.crossings for kept in rows)
    closed = max(run.found.statistics.residual for run in runs)
    return (
        *checks,
        Check.at_most("All motions: rate errors, against what each is allowed", share, 1.0, "", "reference"),
        Check.at_most("A02, all lengths: energy error over 20 s", drift, _ENERGY, "J", "IFToMM, over 10 s"),
        Check.at_least("A02, all lengths: flat poses passed", float(passed), 20, "", "two each turn"),
        Check.at_most("All motions: largest gap in the loops", closed, _CLOSED, "m", "rounding"),
    )


def _chart(runs: list[Repeated]) -> str:
    """Panels two by two."""
    rows = (len(runs) + 1) // 2
    height = 2.7 * rows + 0.7
    with drawing(9.4, height, fixed=True) as canvas:
        edges = {"left": 0.075, "right": 0.96, "bottom": 0.75 / height, "top": 1 - 0.3 / height}
        places = canvas.add_gridspec(rows, 2, **edges, wspace=0.25, hspace=0.33)
        for k, run in enumerate(runs):
            inner = places[divmod(k, 2)].subgridspec(2, 1, height_ratios=[2.0, 1.1], hspace=0.14)
            top, bottom = canvas.add_subplot(inner[0]), canvas.add_subplot(inner[1])
            draw_panel(top, bottom, _panel(run), float(run.found.t[-1]))
            bottom.set_xlabel("time [s]")
        canvas.legend(*bottom.get_legend_handles_labels(), loc="lower center", ncols=2)
        return svg(canvas)


def _panel(run: Repeated) -> Panel:
    ours, theirs = run.drawn
    names = tuple(_SYMBOLS.get(name, f"${name}$") for name in run.given.drawn)
    series = [Series(run.found.t, ours), Series(run.times, theirs, "o", "")]
    errors = [
        Error("error of positions", run.times[1:], run.positions[1:], BLUE),
        Error("error of rates", run.times[1:], run.rates[1:], ORANGE),
    ]
    return Panel(run.given.title, f"position [{run.given.unit}]", names, series, errors, (1e-17, 1e-3))
