"""The paper's trajectory: forces by inverse dynamics, then the robot driven by them, open loop and with PD."""

import numpy as np

import nullbody
from nullbody.control import FeedForward, desired_motion, paper_reference

robot = nullbody.catalog.three_prs()
model = nullbody.build(nullbody.derive(robot, independent=("s1", "s2", "s3")))
reference = paper_reference()  # s = 0.6 + (0.2, -0.3, -0.2) sin t
desired = desired_motion(model, reference, 3.0)  # all coordinates along it, one branch

print("  t       F1       F2       F3      y")
for t in np.linspace(0, 3, 7):
    print(f"{t:4.1f}", *(f"{force:8.4f}" for force in desired.inputs(t)), f"{desired.state(t)['y']:8.4f}")


def error(motion):
    """Largest distance of a slider from its reference [m]."""
    wanted = np.array([reference(t).position for t in motion.t])
    return abs(motion.q[:, -3:] - wanted).max()


start = desired.state(0.0)
open_loop = nullbody.simulate(model, start, 3.0, u=FeedForward(desired), throw=False)
closed = nullbody.simulate(model, start, 3.0, u=FeedForward(desired, kp=50, kd=4))
print(f"open loop: {open_loop.outcome.name} at t = {open_loop.t[-1]:.2f} s, off by {error(open_loop):.2g} m")
print(f"with PD:   {closed.outcome.name}, off by {error(closed):.2g} m")

assert error(closed) < 1e-12 < 1e-3 < error(open_loop)  # upright, the robot is open-loop unstable
