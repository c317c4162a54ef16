"""Section: motions through singularities, of the independent coordinates and of the mechanism itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from nullbody.catalog import n_four_bar, starts
from nullbody.equations import derive
from nullbody.kinematics import assemble, consistent
from nullbody.model import Model, build
from nullbody.report.case import Case
from nullbody.report.figure import BLACK, BLUE, GREEN, GREY, ORANGE, drawing, svg
from nullbody.report.plant import plant_motion
from nullbody.report.section import Check, Figure, Section, Text, number
from nullbody.simulate import Trajectory, simulate
from nullbody.typing import FloatArray
from nullbody.verify import MultiplierEngine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Chart", "charts", "singular"]

_FALL, _PUSH = 0.8, (0.2, 0.1, 0.15)  # s; m/s of the three sliders
_ROW, _BARS = 4.0, 3  # s, loops
_SAMPLES = 401
_FLOOR = 1e-17  # what a difference of exactly zero is drawn as


@dataclass(frozen=True)
class Chart:
    """Independent coordinates and the time from which they were in use [s]."""

    since: float
    independent: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Fall:
    """The 3-PRS without forces: the motion, |B| of its sliders against its start, and the distance from an engine."""

    found: Trajectory
    delta: FloatArray
    charts: list[Chart]
    apart: FloatArray


@dataclass(frozen=True, eq=False)
class _Row:
    """The row of four-bars: the motion, how far A is from losing rank, and the distance from one equation."""

    found: Trajectory
    regular: FloatArray
    apart: FloatArray


def charts(trajectory: Trajectory) -> list[Chart]:
    """The independent coordinates that a simulation used, one after the other."""
    return [Chart(*used) for used in trajectory.charts]


def singular(case: Case) -> Section:
    """The 3-PRS falls through |B| = 0; a row of four-bars swings through its flat pose."""
    fall, row = _fall(case.model), _row()
    kept, passed = fall.found.statistics, row.found.statistics
    changes = int(np.count_nonzero(np.diff(np.sign(fall.delta))))
    used = "; ".join(f"{', '.join(chart.independent)} from {chart.since:.3f} s" for chart in fall.charts)
    apart = float(fall.apart.max())
    return Section(
        "singular",
        "Through singularities",
        (
            Text(
                "<b>Of the independent coordinates.</b> Where |<i>B</i>| = 0 the three sliders do not determine the "
                "rest, and the paper's equations divide by zero. That is no property of the robot but of the choice: "
                "the simulation changes to other coordinates when the condition of <i>N</i> falls, and goes on. Here "
                "the upright robot is pushed and falls without any forces. Used in turn: "
                f"{used}."
            ),
            Text(
                "<b>Of the mechanism.</b> In its flat pose a row of parallelograms loses rank: it could leave on other "
                "branches, and no choice of coordinates helps. The motion itself is smooth. The simulation makes a "
                "step that ends right before, continues it to right behind, closes the loops there and requires the "
                "rates to be its own; otherwise it ends with a named outcome."
            ),
            Figure(
                _chart(fall, row),
                "Left, the 3-PRS in free fall; dotted lines mark changes of the independent coordinates, named on top. "
                f"Right, {_BARS} four-bars in a row; dotted lines mark flat poses. Top: the motion. Middle: |B| of the "
                "sliders against its start, and the smallest singular value of A against the largest. Bottom, "
                "logarithmic: energy error, and distance from a second road, left multipliers in full coordinates, "
                "which have no independent coordinates, right the one equation of parallel bars. See |B| pass through "
                "zero and A lose rank while the curves on top stay smooth, and no jump of the errors on the left. On "
                f"the right the energy error is largest beside the flat poses, {number(passed.energy_drift)} "
                "J; the benchmark allows 0.1 J.",
            ),
        ),
        (
            Check.at_least("3-PRS in free fall: |B| of the sliders passes zero, times", float(changes), 1, "", "shown"),
            Check.at_least("3-PRS in free fall: independent coordinates changed, times", kept.switches, 1, "", "shown"),
            Check.at_most("3-PRS in free fall: against multipliers", apart, 1e-7, "m, rad", "its rtol 1e-9"),
            Check.at_most("3-PRS in free fall: energy error", kept.energy_drift, 1e-8, "J", "rtol 1e-12"),
            Check.at_least(f"{_BARS} four-bars: flat poses passed", passed.crossings, 4, "", "two each turn"),
            Check.at_most(f"{_BARS} four-bars: energy error", passed.energy_drift, 1e-5, "J", "rtol 1e-10"),
            Check.at_most(
                f"{_BARS} four-bars: against one equation", float(row.apart.max()), 1e-5, "rad", "parallel bars"
            ),
        ),
        {
            "singular.three_prs.switches": kept.switches,
            "singular.three_prs.energy_drift": kept.energy_drift,
            "singular.three_prs.max_difference": apart,
            "singular.n_four_bar.crossings": passed.crossings,
            "singular.n_four_bar.energy_drift": passed.energy_drift,
            "singular.n_four_bar.max_difference": float(row.apart.max()),
        },
    )


def _fall(model: Model) -> _Fall:
    start = assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6}, v=_PUSH)
    found = simulate(model, start, _FALL, rtol=1e-12, samples=_SAMPLES, progress=False)
    delta = np.array([model.evaluate("kinematics", q, v)[3] for q, v in zip(found.q, found.v, strict=True)])
    engine = MultiplierEngine(model.mechanism, model.parameters, model.labels)
    still = np.zeros(len(model.inputs))
    other = plant_motion(engine, model, start, found.t, lambda t, x: still, 1e-9, reach=np.inf)
    apart = np.abs(found.q - other.q).max(axis=1)
    return _Fall(found, delta / delta[0], charts(found), apart)


def _row() -> _Row:
    """N parallel bars with their couplers: theta'' = g lift sin(theta) / (L inertia), as masses at the tops."""
    from scipy.integrate import solve_ivp

    start = starts("n_four_bar", n=_BARS)["upright"]
    model = build(derive(n_four_bar(_BARS))).replace(**start.mechanism.values())
    state = consistent(model, start.q, start.q_dot).state
    found = simulate(model, state, _ROW, rtol=1e-10, samples=_SAMPLES, progress=False)
    sizes = np.array([np.linalg.svd(model.jacobian(q), compute_uv=False) for q in found.q])
    regular = sizes[:, -1] / sizes[:, 0]
    p = model.parameters
    lift, inertia = (_BARS + 1) * p["m"] / 2 + _BARS * p["mc"], (_BARS + 1) * p["m"] / 3 + _BARS * p["mc"]
    pull = p["g"] * lift / (p["L"] * inertia)
    one = solve_ivp(
        lambda t, y: [y[1], pull * np.sin(y[0])],
        (0.0, _ROW),
        [found["theta0"][0], found["theta0'"][0]],
        "DOP853",
        found.t,
        rtol=1e-13,
        atol=1e-14,
    )
    bars = found.q[:, : _BARS + 1]
    return _Row(found, regular, np.abs(bars - one.y[0][:, None]).max(axis=1))


def _chart(fall: _Fall, row: _Row) -> str:
    flat = [float(row.found.t[k]) for k in _lowest(row.regular)]
    changes = [chart.since for chart in fall.charts[1:]]
    with drawing(9.6, 7.6) as canvas:
        grid = canvas.subplots(3, 2, sharex="col", height_ratios=[1.5, 1, 1.2])
        for column, times in zip(grid.T, (changes, flat), strict=True):
            for axes, t in product(column, times):
                axes.axvline(t, color=GREY, lw=0.9, ls=":")
        _fall_panels(grid[:, 0], fall)
        _row_panels(grid[:, 1], row)
        return svg(canvas)


def _lowest(values: FloatArray) -> Sequence[int]:
    """Where a positive curve has its deep minima."""
    inner = values[1:-1]
    deep = (inner < values[:-2]) & (inner <= values[2:]) & (inner < 0.1 * float(values.max()))
    found: list[int] = (np.flatnonzero(deep) + 1).tolist()
    return found


def _fall_panels(axes: Sequence[Axes], fall: _Fall) -> None:
    found, (top, middle, bottom) = fall.found, axes
    for name, label, colour in (("y", "$y$ [m]", BLUE), ("psi", r"$\psi$ [rad]", ORANGE), ("s1", "$s_1$ [m]", GREEN)):
        top.plot(found.t, found[name], color=colour, label=label)
    low, high = top.get_ylim()
    top.set_ylim(low, high + 0.45 * (high - low))
    top.legend(loc="lower left")
    ends = [*(chart.since for chart in fall.charts[1:]), float(found.t[-1])]
    for chart, end in zip(fall.charts, ends, strict=True):
        names = "\n".join(_symbol(name) for name in chart.independent)
        middle_of = (chart.since + end) / 2
        top.text(middle_of, 0.98, names, transform=top.get_xaxis_transform(), ha="center", va="top", fontsize=8)
    top.set_title("3-PRS in free fall")
    middle.plot(found.t, fall.delta, color=BLACK)
    middle.axhline(0, color=GREY, lw=0.9)
    middle.set_ylabel(r"$|B|$ of $s_1, s_2, s_3$")
    _errors(bottom, found, fall.apart, "against multipliers [m, rad]")


def _row_panels(axes: Sequence[Axes], row: _Row) -> None:
    found, (top, middle, bottom) = row.found, axes
    top.plot(found.t, found["theta0"], color=BLUE, label=r"$\theta_0$ [rad]")
    top.plot(found.t, found["theta0'"], color=ORANGE, label=r"$\theta_0'$ [rad/s]")
    top.legend(loc="upper left")
    top.set_title(f"{_BARS} four-bars in a row")
    middle.semilogy(found.t, row.regular, color=BLACK)
    middle.set_ylabel("smallest / largest σ of A")
    _errors(bottom, found, row.apart, "against one equation [rad]")


def _errors(axes: Axes, found: Trajectory, apart: FloatArray, label: str) -> None:
    energy = found.kinetic + found.potential - found.work
    lines = (("energy error [J]", energy - energy[0], BLUE), (label, apart, ORANGE))
    for name, values, colour in lines:
        axes.semilogy(found.t, np.maximum(np.abs(values), _FLOOR), color=colour, lw=1.2, label=name)
    axes.set_ylim(_FLOOR, 1e-2)
    axes.set_xlim(0, float(found.t[-1]))
    axes.set_xlabel("time [s]")
    axes.legend(loc="upper left")


def _symbol(name: str) -> str:
    """A coordinate of the 3-PRS in mathematical type."""
    letters = name.rstrip("123")
    greek = f"\\{letters}" if len(letters) > 1 else letters
    return f"${greek}_{name[-1]}$" if name != letters else f"${greek}$"
