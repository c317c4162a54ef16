"""The simulations that the figures and the tracking section share, on one grid of times."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from nullbody.control import ComputedTorque, desired_motion, paper_reference
from nullbody.equations import derive
from nullbody.mechanism import Mechanism
from nullbody.model import State, build
from nullbody.report.case import Case
from nullbody.report.plant import Motion, plant_motion
from nullbody.simulate import Trajectory, simulate
from nullbody.typing import FloatArray
from nullbody.verify import MultiplierEngine

__all__ = ["PD_GAINS", "ForceTable", "Runs", "end_inertia", "motion_of", "simulated_runs"]

PD_GAINS = (50.0, 4.0)  # Kp [N/m], Kd [N s/m]
_OPEN_RTOL = 1e-10


@dataclass(frozen=True, eq=False)
class Runs:
    """Motions of the robot on the paper's trajectory, by how they were driven.

    Attributes:
        desired: every coordinate and rate of the desired motion.
        open_loop: forces of inverse dynamics alone, DOP853 at rtol 1e-10; ends where it falls over.
        computed_torque: closed loop, Kp 100, Kd 20.
        feed_forward: the same forces with PD feedback.
        shortcut: feed-forward by the model with m l^2/3, PD feedback; the robot itself is right.
        feedback_only: PD without feed-forward, in full coordinates (it passes a singularity of s1, s2, s3).
        engines_open, engines_closed: open loop and computed torque with an engine as the robot, by name.
        closure: largest |Phi| of the stored samples of the projected simulations [m].
    """

    desired: Motion
    open_loop: Motion
    computed_torque: Motion
    feed_forward: Motion
    shortcut: Motion
    feedback_only: Motion
    engines_open: Mapping[str, Motion]
    engines_closed: Mapping[str, Motion]
    closure: float


def simulated_runs(case: Case, step: Callable[[str], None]) -> Runs:
    """Run all simulations; `step` is told which comes next."""
    model, desired = case.model, case.desired
    step("open loop")
    forces = ForceTable(desired.inputs, case.settings.duration)
    open_loop = _simulated(case, lambda t, x: forces(t), rtol=_OPEN_RTOL)
    step("closed loops")
    torque = ComputedTorque(model, paper_reference())
    computed = _simulated(case, torque, rtol=1e-12)
    feedback = _feedback(case)
    feed_forward = _simulated(case, lambda t, x: forces(t) + feedback(t, x))
    step("closed loop with the inertia m l^2/3")
    wrong = build(derive(end_inertia(case.equations.mechanism), model.independent))
    wrong_motion = desired_motion(wrong, paper_reference(), case.settings.duration)
    wrong_forces = ForceTable(wrong_motion.inputs, case.settings.duration)
    shortcut = _simulated(case, lambda t, x: wrong_forces(t) + feedback(t, x))
    step("engines as the robot")
    start = case.states[0]
    engines = case.engines.items()
    engines_open = {
        name: plant_motion(engine, model, start, case.times, lambda t, x: forces(t), _OPEN_RTOL)
        for name, engine in engines
    }
    engines_closed = {name: plant_motion(engine, model, start, case.times, torque) for name, engine in engines}
    plant = case.engines.get("pinocchio") or MultiplierEngine(model.mechanism, model.parameters, model.labels)
    feedback_only = plant_motion(plant, model, start, case.times, feedback, 1e-7)
    projected = (open_loop, computed, feed_forward, shortcut)
    return Runs(
        desired=_desired(case),
        open_loop=motion_of(open_loop, case.times),
        computed_torque=motion_of(computed, case.times),
        feed_forward=motion_of(feed_forward, case.times),
        shortcut=motion_of(shortcut, case.times),
        feedback_only=feedback_only,
        engines_open=engines_open,
        engines_closed=engines_closed,
        closure=max(trajectory.statistics.residual for trajectory in projected),
    )


def end_inertia(mechanism: Mechanism) -> Mechanism:
    """The robot with the paper's [29]: links with m l^2/3, which is about their ends, at their centres."""
    shortcut = ("m*l^2/3", "m*l^2/3", 0)
    bodies = (replace(b, inertia=shortcut) if b.name.startswith("link") else b for b in mechanism.bodies)
    return replace(mechanism, bodies=tuple(bodies))


def motion_of(trajectory: Trajectory, times: FloatArray) -> Motion:
    """A simulation at given times, as far as it came, with all rates q' = N v."""
    kept = times[times <= trajectory.t[-1]]
    sample = trajectory.sample(kept)
    rates = [trajectory.model.evaluate("kinematics", q, v)[2] for q, v in zip(sample.q, sample.v, strict=True)]
    return Motion(kept, sample.q, np.array(rates))


class ForceTable:
    """Forces of inverse dynamics over time, interpolated between Chebyshev points to about 1e-14 N.

        F(t) = sum_k w_k F_k / (t - t_k) / sum_k w_k / (t - t_k)          (barycentric, Berrut and Trefethen 2004)

    Args:
        inputs: F(t) [N].
        end: the table covers 0..end [s].
        count: number of points.
    """

    def __init__(self, inputs: Callable[[float], FloatArray], end: float, count: int = 96) -> None:
        self._times = end / 2 * (1 - np.cos(np.pi * np.arange(count + 1) / count))
        self._forces = np.array([inputs(float(t)) for t in self._times])
        self._weights = np.where(np.arange(count + 1) % 2, -1.0, 1.0)
        self._weights[[0, -1]] /= 2

    def __call__(self, t: float) -> FloatArray:
        """F(t) [N]."""
        distance = t - self._times
        at = int(np.abs(distance).argmin())
        if distance[at] == 0:
            exact: FloatArray = self._forces[at].copy()
            return exact
        share = self._weights / distance
        found: FloatArray = share @ self._forces / share.sum()
        return found


def _simulated(case: Case, u: Callable[[float, State], FloatArray], rtol: float = 1e-10) -> Trajectory:
    start, end = case.states[0], case.settings.duration
    return simulate(case.model, start, end, u=u, rtol=rtol, throw=False, progress=False)


def _feedback(case: Case) -> Callable[[float, State], FloatArray]:
    """PD alone: u = Kp (s_d - s) + Kd (s'_d - s')"""
    kp, kd = PD_GAINS
    free = case.model.independent_columns

    def u(t: float, x: State) -> FloatArray:
        demand = case.desired.demand(t)
        force: FloatArray = kp * (demand.position - x.q[free]) + kd * (demand.rate - x.v)
        return force

    return u


def _desired(case: Case) -> Motion:
    q = np.array([x.q for x in case.states])
    return Motion(case.times, q, np.array([case.model.velocity(x) for x in case.states]))
