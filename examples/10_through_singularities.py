"""Through singularities: of the independent coordinates (a 3-PRS falls through |B| = 0), and of the mechanism itself.

With --figure it also draws through_singularities.png.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

import nullbody

# Of the choice. Where |B| = 0 the sliders do not determine the rest; the simulation goes on in other coordinates.
robot = nullbody.catalog.three_prs()
model = nullbody.build(nullbody.derive(robot, independent=("s1", "s2", "s3")))
upright = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6}, v=[0.2, 0.1, 0.15])
fall = nullbody.simulate(model, upright, 0.8, samples=401)
delta = np.array([nullbody.singularity(model, fall.state(t)).delta for t in fall.t])
zeros = fall.t[1:][np.diff(np.sign(delta)) != 0]
print(fall, f"switches: {fall.statistics.switches}; |B| = 0 near t =", *(f"{t:.3f}" for t in zeros), "s")
fixed = nullbody.simulate(model, upright, 0.8, switch=False, throw=False)
print(f"without a switch: {fixed.outcome.name} at t = {fixed.t[-1]:.4f} s")

# Of the mechanism. Lying flat, a row of parallelograms could go on in several ways: A loses rank for every choice.
begin = nullbody.catalog.starts("n_four_bar", n=3)["upright"]
row = nullbody.build(nullbody.derive(begin.mechanism))
swing = nullbody.simulate(row, nullbody.consistent(row, begin.q, begin.q_dot).state, 4.0, samples=401)
sizes = np.array([np.linalg.svd(row.jacobian(q), compute_uv=False)[[0, -1]] for q in swing.q])
print(swing, f"flat poses passed: {swing.statistics.crossings}; singular values of A down to {sizes[:, 1].min():.1e}")

# As long as the bars stay parallel, theta'^2 = theta'_0^2 + 2 k (1 - cos theta), see the docstring of n_four_bar.
p, n = row.parameters, 3
lift, inertia = (n + 1) * p["m"] / 2 + n * p["mc"], (n + 1) * p["m"] / 3 + n * p["mc"]
exact = 1 + 2 * p["g"] * lift / (p["L"] * inertia) * (1 - np.cos(swing["theta0"]))

if "--figure" in sys.argv:
    figure = Figure(figsize=(9, 5), layout="constrained")
    (left, right), (below, beside) = figure.subplots(2, 2, sharex="col")
    left.plot(fall.t, fall["y"], label="y [m]")
    left.plot(fall.t, fall["s1"], label="s1 [m]")
    left.set_title("3-PRS in free fall")
    below.plot(fall.t, delta / delta[0], label="|B| against its start")
    below.axhline(0, color="grey", lw=0.8)
    right.plot(swing.t, swing["theta0"], label="theta0 [rad]")
    right.set_title("three four-bars in a row")
    beside.semilogy(swing.t, sizes[:, 1] / sizes[:, 0], label="smallest / largest singular value of A")
    beside.set_ylim(1e-3, 3)
    for axes in (left, right, below, beside):
        axes.legend()
    below.set_xlabel("t [s]")
    beside.set_xlabel("t [s]")
    figure.savefig("through_singularities.png")

assert len(zeros) and fall.statistics.switches and fall.statistics.energy_drift < 1e-8 and not fixed.outcome.ok
assert swing.statistics.crossings >= 4 and abs(swing["theta0'"] ** 2 - exact).max() < 1e-4
