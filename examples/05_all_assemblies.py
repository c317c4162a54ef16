"""All the ways to assemble the robot for the same sliders, and how near each is to a singularity."""

import nullbody

robot = nullbody.catalog.three_prs()
model = nullbody.build(nullbody.derive(robot, independent=("s1", "s2", "s3")))
sliders = {"s1": 0.65, "s2": 0.55, "s3": 0.60}
found = nullbody.branches(model, sliders)  # complete: from a polynomial of degree 16

print(f"{len(found)} assemblies for {sliders}, complete: {found.complete}")
print("      y    alpha1  alpha2  alpha3  forward  inverse")
for state in found:
    measure = nullbody.singularity(model, state)
    angles = "".join(f"{state[f'alpha{i}']:8.3f}" for i in (1, 2, 3))
    print(f"{state['y']:8.4f}{angles}{measure.forward:9.3f}{measure.inverse:9.3f}")

# The platform's pose of each, put into the inverse kinematics with the state as its guess, gives back the sliders.
for state in found:
    pose = {name: state[name] for name in ("y", "psi", "phi")}
    again = nullbody.inverse_kinematics(model, pose, guess=state)
    assert abs(again.q[-3:] - state.q[-3:]).max() < 1e-6, state
assert found.complete and all(abs(model.residual(state.q)).max() < 1e-14 for state in found)
