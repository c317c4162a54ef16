"""Section: what the paper gets wrong, each with a number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nullbody.report.case import END, Case
from nullbody.report.figure import BLACK, BLUE, GREEN, ORANGE, drawing, svg
from nullbody.report.section import Check, Figure, Part, Section, Table, Text, number
from nullbody.report.variant import (
    EQUATION_41,
    GRAVITY,
    INERTIA,
    NO_COUPLING,
    RIGHT,
    Path,
    Robot,
    random_errors,
)
from nullbody.typing import FloatArray

__all__ = ["erratum"]

_EQ41_TIME = 0.8  # s
_EQ41_TRUE = (-0.1435, 0.2152, 0.1435)  # theory, to four digits
_EQ41_PAPER = (-0.1463, 0.1184, 0.1464)
_FALL_TIME = 1.5  # s


@dataclass(frozen=True, eq=False)
class _Found:
    """What the section reports.

    Attributes:
        path: along the desired motion.
        force, acceleration: largest errors there, by variant [N, m/s^2].
        random: median relative errors of accelerations at random states, by variant.
        literal, true: slider accelerations at 0.8 s by equation 41, and right [m/s^2].
        up, down: y'' of the platform let go, with the printed and the right sign of gravity [m/s^2].
    """

    path: Path
    force: Mapping[str, float]
    acceleration: Mapping[str, float]
    random: Mapping[str, float]
    literal: FloatArray
    true: FloatArray
    up: float
    down: float


def erratum(case: Case) -> Section:
    """Each erratum by a number, along the paper's motion and at random states."""
    robot, end = Robot(case), case.settings.duration
    path = Path.of(case, robot)
    t = min(_EQ41_TIME, end)
    at = robot.accelerations(case.desired.state(t), case.desired.inputs(t))
    found = _Found(
        path,
        path.worst(path.forces),
        path.worst(path.accelerations),
        random_errors(case, robot),
        at[EQUATION_41],
        at[RIGHT],
        *robot.fall(case.desired.state(min(_FALL_TIME, end))),
    )
    return Section(
        "errata",
        "Errata: what the paper gets wrong",
        (*_comparison(case, found), *_explanations(found)),
        _checks(found, whole=end >= END),
        {
            "errata.eq41_error": float(np.abs(found.literal - found.true).max()),
            "errata.eq41_force_error": found.force[EQUATION_41],
            "errata.ml2_over_3_force_error": found.force[INERTIA] / path.peak,
            "errata.ml2_over_3_acceleration_error": found.random[INERTIA],
            "errata.gravity_sign_error": found.force[GRAVITY],
            "errata.missing_coupling_error": found.acceleration[NO_COUPLING],
            "errata.missing_coupling_force_error": found.force[NO_COUPLING] / path.peak,
        },
    )


def _comparison(case: Case, found: _Found) -> tuple[Part, ...]:
    """All variants side by side."""
    rows = tuple(
        (
            name,
            number(force),
            f"{100 * force / found.path.peak:.2f} %",
            number(found.acceleration[name]),
            f"{100 * found.random[name]:.3g} %",
        )
        for name, force in found.force.items()
    )
    head = ("variant", ">forces: max error [N]", ">of the peak", ">accelerations: max error [m/s²]", ">random states")
    return (
        Text(
            "Four statements of the paper are not those of rigid-body mechanics. The package does not contain "
            "them; here they are put into its correct equations one at a time, and the result is compared."
        ),
        Table(
            head,
            rows,
            f"Along the paper's motion (peak force {found.path.peak:.3f} N); last column: the median relative error of "
            f"slider accelerations over {case.settings.errata_states} random states with random forces.",
        ),
        Figure(
            _chart(found.path),
            "Error of the forces (left) and of the slider accelerations (right) that each variant makes along "
            "the paper's motion. See that three of the four stay below 1 % of the forces, so that a force plot "
            "such as Fig. 5 cannot reveal them; only the sign of gravity would be seen. At random states, "
            "where forces are not those of a slow motion, m l²/3 and the missing coupling change accelerations "
            "by tens of per cent (table).",
        ),
    )


def _explanations(found: _Found) -> tuple[Part, ...]:
    """Erratum by erratum."""
    rows = (
        ("equation 41 literally", *(f"{value:.4f}" for value in (*_EQ41_PAPER, *found.literal))),
        ("correct", *(f"{value:.4f}" for value in (*_EQ41_TRUE, *found.true))),
    )
    head = ("slider accelerations [m/s²]", ">s₁'' expected", ">s₂''", ">s₃''", ">s₁'' found", ">s₂''", ">s₃''")
    return (
        Text(
            "<b>Equation 41</b> takes <i>N'v</i> = −<i>A</i><sup>+</sup><i>A'q'</i> with the pseudo-inverse. "
            "That vector satisfies the constraints, but its independent rows are not zero, so what [43] solves "
            "for is not <i>v'</i>. At t = 0.8 s, for the right forces:"
        ),
        Table(head, rows, "Expected: to four digits, from the theory of the robot."),
        Text(
            "The paper uses the same vector in its inverse and in its forward dynamics, so the round trip of "
            "Figs. 6 and 7 cancels the error and cannot reveal it."
        ),
        Text(
            "<b>The links' inertia</b> m l²/3 in [29] is about the end of a rod, but [27] adds the translation "
            "of its centre: the rod counts twice. About the centre it is m l²/12."
        ),
        Text(
            "<b>The sign of gravity.</b> [35] lists −9.8 for <i>y</i>; with U = M g y [31] and [34] it is +M g. "
            f"With the printed sign the robot, let go at t = {_FALL_TIME:g} s, accelerates its platform by "
            f"{number(found.up)} m/s² instead of {number(found.down)} m/s²: upwards."
        ),
        Text(
            "<b>The missing coupling.</b> A link's centre moves with both its slider and its angle, so the mass "
            "matrix has <i>M</i>[α<sub>i</sub>, <i>s<sub>i</sub></i>] = −m (l/2) sin α<sub>i</sub>; [35] shows "
            "zero there."
        ),
    )


def _checks(found: _Found, *, whole: bool) -> tuple[Check, ...]:
    """What the theory says of each erratum; some of it only of the whole motion."""
    literal = _distance(found.literal, _EQ41_PAPER) if whole else None
    true = _distance(found.true, _EQ41_TRUE) if whole else None
    share = found.force[INERTIA] / found.path.peak if whole else None
    at = "accelerations at 0.8 s, off the theory's"
    return (
        Check.at_most(f"Equation 41 literally: {at}", literal, 1e-4, "m/s²", "-0.1463, 0.1184, 0.1464"),
        Check.at_most(f"Correct: {at}", true, 1e-4, "m/s²", "-0.1435, 0.2152, 0.1435"),
        Check.near("m l²/3: error of the forces, part of the peak", share, 0.0045, 3e-4, "", "theory: 0.45 %"),
        Check.near("m l²/3: median error of accelerations", found.random[INERTIA], 0.38, 0.06, "", "theory: 37 %"),
        Check.holds("Printed sign of gravity: the platform falls upwards", found.up > 0 > found.down, "it is wrong"),
        Check.at_least(
            "Missing coupling: error of accelerations", found.acceleration[NO_COUPLING], 1e-3, "m/s²", "it is wrong"
        ),
    )


def _distance(found: FloatArray, expected: tuple[float, ...]) -> float:
    return float(np.abs(found - np.array(expected)).max())


def _chart(path: Path) -> str:
    colours = {EQUATION_41: BLUE, INERTIA: ORANGE, GRAVITY: BLACK, NO_COUPLING: GREEN}
    with drawing(9.2, 3.4) as canvas:
        pairs = (("force error [N]", path.forces), ("acceleration error [m/s²]", path.accelerations))
        for axes, (label, found) in zip(canvas.subplots(1, 2), pairs, strict=True):
            for name, colour in colours.items():
                error = np.abs(found[name] - found[RIGHT]).max(axis=1)
                axes.semilogy(path.times, np.maximum(error, 1e-6), color=colour, label=name)
            axes.set_xlabel("time [s]")
            axes.set_ylabel(label)
            axes.set_xlim(0, path.times[-1])
        handles, labels = canvas.axes[0].get_legend_handles_labels()
        canvas.legend(handles, labels, loc="outside lower center", ncols=4)
        return svg(canvas)
