"""Section: open loop falls over, closed loop holds."""

from __future__ import annotations

import numpy as np

from nullbody.report.case import END, Case
from nullbody.report.figure import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, drawing, svg
from nullbody.report.growth import Growth, linear_growth
from nullbody.report.plant import Motion
from nullbody.report.run import PD_GAINS, Runs
from nullbody.report.section import Check, Figure, Section, Table, Text, number

__all__ = ["time_to", "tracking"]

_MILLIMETRE = 1e-3
_KNOWN = {0.5: 43.0, 1.0: 2e4, 1.75: 4e8}  # growth of one perturbation of s', from the reference study


def tracking(case: Case, runs: Runs) -> Section:
    """Open-loop divergence with its growth rate, and the closed loops that hold."""
    growth = linear_growth(case)
    torque, feed = _worst(case, runs.computed_torque), _worst(case, runs.feed_forward)
    return Section(
        "tracking",
        "Tracking: open loop diverges, closed loop holds",
        (
            Text(
                "The upright robot is unstable: the platform rests on hinged legs. The paper drives its forward "
                "model with the forces of its inverse model and reports an error below 1e-3 for 3 s. With forces as "
                "functions of time alone nothing pushes an error back, so rounding itself grows: the linearised "
                f"equations amplify a small speed error at {number(growth.rate)} per second, "
                f"{number(growth.at(0.5))}-fold by 0.5 s, {number(growth.at(1.0))}-fold by 1 s and "
                f"{number(growth.at(1.75))}-fold by 1.75 s (metres per m/s, worst direction)."
            ),
            Figure(
                _chart(case, runs, growth),
                "Largest slider error over time, logarithmic. See the open loop (black, and dotted with an engine "
                "as the robot) climb parallel to the grey line, the predicted growth of 1e-14 m/s of speed error, "
                "and cross 1 mm near 2 s; the closed loops stay at the bottom. With m l²/3 in the controller the "
                "PD loop holds to 1 mm only; without feed-forward it is off by 17 cm.",
            ),
            _table(case, runs),
        ),
        _checks(case, runs, growth),
        {
            "tracking.open_loop_time_to_1mm": time_to(case, runs.open_loop, _MILLIMETRE),
            "tracking.open_loop_growth_rate": growth.rate,
            "tracking.amplification": {f"{t:g}": growth.at(t) for t in _KNOWN},
            "tracking.closed_loop_max_error": max(torque, feed),
            "tracking.shortcut_max_error": _worst(case, runs.shortcut),
            "tracking.feedback_only_max_error": _worst(case, runs.feedback_only),
        },
    )


def _table(case: Case, runs: Runs) -> Table:
    """One row for each run."""
    kp, kd = PD_GAINS
    named = [
        ("open loop (the paper's Figs. 6, 7)", runs.open_loop),
        *((f"open loop, the robot is {name}", run) for name, run in runs.engines_open.items()),
        ("computed torque, Kp 100, Kd 20", runs.computed_torque),
        *((f"computed torque, the robot is {name}", run) for name, run in runs.engines_closed.items()),
        (f"feed-forward + PD, Kp {kp:g}, Kd {kd:g}", runs.feed_forward),
        ("the same, forces from the m l²/3 model", runs.shortcut),
        ("PD without feed-forward", runs.feedback_only),
    ]
    rows = []
    for name, run in named:
        crossed = time_to(case, run, _MILLIMETRE)
        when = "never" if crossed is None else f"{crossed:.2f} s"
        rows.append((name, when, f"{run.times[-1]:.2f} s", number(_worst(case, run))))
    return Table(
        ("drive", ">1 mm exceeded at", ">ended at", ">worst slider error [m]"),
        tuple(rows),
        "All on the correct robot for 3 s. The open-loop runs end where a slider has run away or where s₁, s₂, s₃ "
        "become singular; PD without feed-forward was run in full coordinates, for it passes that singularity.",
    )


def _checks(case: Case, runs: Runs, growth: Growth) -> tuple[Check, ...]:
    """The closed loops hold, the open loop does not; some of it is known only for the whole motion."""
    whole = case.settings.duration >= END
    torque, feed = _worst(case, runs.computed_torque), _worst(case, runs.feed_forward)
    shortcut = _worst(case, runs.shortcut) if whole else None
    feedback = _worst(case, runs.feedback_only) if whole else None
    checks = [
        Check.at_most("Closed loop, computed torque: worst slider error", torque, 1e-10, "m", "rtol 1e-12"),
        Check.at_most("Closed loop, feed-forward and PD: worst slider error", feed, 1e-10, "m", "theory: 1.3e-15 m"),
        Check.near("PD with feed-forward by m l²/3: worst error", shortcut, 1e-3, 1e-4, "m", "theory"),
        Check.near("PD without feed-forward: worst error", feedback, 0.17, 0.02, "m", "theory"),
    ]
    for name, run in {"this package": runs.open_loop, **runs.engines_open}.items():
        crossed = time_to(case, run, _MILLIMETRE) if whole else None
        checks.append(Check.near(f"Open loop, {name}: time until 1 mm", crossed, 1.93, 0.2, "s", "theory, rtol 1e-10"))
    for t, known in _KNOWN.items():
        what, words = f"Amplification of a speed error by {t:g} s", f"{number(known)}, within a factor of 2 (theory)"
        checks.append(Check(what, growth.at(t), known / 2, known * 2, words))
    return tuple(checks)


def time_to(case: Case, run: Motion, limit: float) -> float | None:
    """When the slider error first exceeds a limit, interpolated in its logarithm; nothing if it never does [s]."""
    error = np.maximum(case.tracking_error(run.times, run.q), 1e-17)
    above = np.flatnonzero(error > limit)
    if not len(above):
        return None
    k = int(above[0])
    if k == 0:
        return float(run.times[0])
    low, high = np.log(error[k - 1 : k + 1])
    share = (np.log(limit) - low) / (high - low)
    return float(run.times[k - 1] + share * (run.times[k] - run.times[k - 1]))


def _worst(case: Case, run: Motion) -> float:
    return float(case.tracking_error(run.times, run.q).max())


def _chart(case: Case, runs: Runs, growth: Growth) -> str:
    """Errors of all runs over time with the predicted growth."""
    lines = [
        ("open loop", runs.open_loop, BLACK, "-"),
        *(
            (f"open loop, {name}", run, colour, ":")
            for (name, run), colour in zip(runs.engines_open.items(), (ORANGE, PURPLE), strict=False)
        ),
        ("PD only", runs.feedback_only, SKY, "-"),
        ("PD, m l²/3", runs.shortcut, ORANGE, "-"),
        ("PD, feed-forward", runs.feed_forward, GREEN, "-"),
        ("computed torque", runs.computed_torque, BLUE, "-"),
    ]
    with drawing(9.0, 4.3) as canvas:
        axes = canvas.subplots()
        for label, run, colour, style in lines:
            error = np.maximum(case.tracking_error(run.times, run.q), 1e-17)
            axes.semilogy(run.times, error, color=colour, ls=style, label=label)
        expected = 1e-14 * growth.factor[1:]
        axes.semilogy(growth.times[1:], expected, color=GREY, lw=5, alpha=0.35, zorder=0, label="1e-14 m/s, linearised")
        axes.axhline(_MILLIMETRE, color=GREY, lw=0.9, ls="--")
        axes.text(0.02, 1.3e-3, "1 mm", color=GREY)
        axes.set_xlim(0, case.settings.duration)
        axes.set_ylim(1e-17, 1e1)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("largest slider error [m]")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return svg(canvas)
