"""The five nouns: a parallel robot from mechanism to motion, hanging below its slides."""

import nullbody

robot = nullbody.catalog.three_prs()  # Mechanism: bodies, joints, loops as data
equations = nullbody.derive(robot, independent=("s1", "s2", "s3"))  # Equations: closed form
model = nullbody.build(equations)  # Model: native code

below = {"y": -0.5, "alpha1": -1.5, "alpha2": -1.5, "alpha3": -1.5}  # the branch: legs down
hanging = nullbody.assemble(model, {"s1": 0.55, "s2": 0.60, "s3": 0.62}, guess=below)  # State: loops closed
swing = nullbody.simulate(model, hanging, t1=2.0)  # Trajectory: adaptive steps, nothing driven

print(equations)
print(swing)
for t in (0.0, 0.5, 1.0, 1.5, 2.0):
    state = swing.state(t)
    print(f"t = {t:.1f} s: platform at y = {state['y']:.4f} m, rolled by {state['psi']:+.4f} rad")

assert swing.outcome.ok and swing.statistics.residual < 1e-13 and swing.statistics.energy_drift < 1e-9
