"""Constraints on rates, and on time: a rolling disc, a sleigh on a blade, and a crank that follows a given angle."""

import numpy as np

import nullbody

# Nonholonomic: a disc rolls without slip. Its rates have 3 degrees of freedom, its positions 5. Tilted by 20 degrees
# and started right, its centre runs in a circle.
steady = nullbody.catalog.starts("rolling_disc")["steady"]
disc = nullbody.build(nullbody.derive(steady.mechanism))
print(disc.mobility)
rolls = nullbody.simulate(disc, nullbody.consistent(disc, steady.q, steady.q_dot).state, 5.0, samples=201)
circle = np.column_stack([rolls["x"], rolls["y"], np.ones(201)])
x0, y0, _ = np.linalg.lstsq(2 * circle, rolls["x"] ** 2 + rolls["y"] ** 2, rcond=None)[0]
radii = np.hypot(rolls["x"] - x0, rolls["y"] - y0)
force = dict(zip(disc.labels, disc.reactions(rolls.state(2.5)), strict=True))
print(f"radius of the circle {radii.mean():.6f} m, to {np.ptp(radii):.0e} m; load {force['contact height']:.4f} N")

# A sleigh on one blade, started backwards, turns round by itself: v = A tanh(k t + c), see its docstring.
backwards = nullbody.catalog.starts("chaplygin_sleigh")["backwards"]
sleigh = nullbody.build(nullbody.derive(backwards.mechanism))
slides = nullbody.simulate(sleigh, nullbody.consistent(sleigh, backwards.q, backwards.q_dot).state, 20.0, samples=201)
a, m, J = 0.1, 1.0, 0.1 + 1.0 * 0.1**2
A = np.sqrt(0.5**2 + J / m)
exact = A * np.tanh(a * A * m / J * slides.t + np.arctanh(-0.5 / A))
speed = slides["x'"] * np.cos(slides["phi"]) + slides["y'"] * np.sin(slides["phi"])
print(f"sleigh: from {speed[0]:+.3f} to {speed[-1]:+.3f} m/s, turned by {np.degrees(slides['phi'][-1]):.1f} degrees")

# Rheonomic: the angle of a crank is a function of the time. No degree of freedom is left; the motion costs a torque.
b = nullbody.MechanismBuilder("drive", gravity=(0, -9.81, 0), own="planar")
b.rod("crank", 0.5, 0.1)
b.rod("rod", 0.4, 0.35)
b.box("slider", 0.8, (0.05, 0.05, 0.05))
b.revolute("shaft", "ground", "crank")
b.revolute("pin", "crank", "rod", at=(0.1, 0, 0))
b.revolute("wrist", "rod", "slider", at=(0.35, 0, 0))
b.prismatic("rail", "ground", "slider", axis="x")
b.driver("motor", "shaft", "8*t + 0.5*sin(8*t)")
driven = nullbody.build(nullbody.derive(b.build()))
turns = nullbody.simulate(driven, nullbody.assemble(driven, {}), 0.7, samples=701)
place = driven.labels.index("motor drive")  # M q'' + h + A^T lambda = Q: the torque on the crank is -lambda
torque = [-driven.reactions(turns.state(t))[place] for t in turns.t]
work = np.trapezoid(torque * turns["shaft'"], turns.t)
energy = turns.kinetic + turns.potential
print(f"{driven.mobility}\ntorque {min(torque):.2f} to {max(torque):.2f} N m; work {work:.4f} J")

angle = 8 * turns.t + 0.5 * np.sin(8 * turns.t)
assert np.ptp(radii) < 1e-8 and abs(speed - exact).max() < 1e-8
assert abs(turns["shaft"] - angle).max() < 1e-12 and abs(work - (energy[-1] - energy[0])) < 1e-4
