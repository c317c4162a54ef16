"""Computed torque: from a start that is off, to a point, with a platform heavier than the controller believes."""

import nullbody
from nullbody.control import ComputedTorque, Quintic

robot = nullbody.catalog.three_prs()
model = nullbody.build(nullbody.derive(robot, independent=("s1", "s2", "s3")))
reference = Quintic(start=(0.60, 0.60, 0.60), end=(0.70, 0.55, 0.50), duration=1.5)  # at rest at both ends
off = nullbody.assemble(model, {"s1": 0.61, "s2": 0.59, "s3": 0.605})


def final_error(robot_model, kp, kd):
    """Distance from the goal after 3 s [mm]; the controller believes in `model`."""
    controller = ComputedTorque(model, reference, kp=kp, kd=kd)
    motion = nullbody.simulate(robot_model, off, 3.0, u=controller)
    return 1000 * abs(motion.q[-1, -3:] - reference.end).max()


right = final_error(model, 100, 20)
heavy = final_error(model.replace(M=1.1), 100, 20)
stiff = final_error(model.replace(M=1.1), 400, 40)
print(f"right model:              {right:.6f} mm")
print(f"platform 10 % heavier:    {heavy:.2f} mm")
print(f"the same, gain 4 x:       {stiff:.2f} mm")

assert right < 1e-3 and stiff < heavy / 3
