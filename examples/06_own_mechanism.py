"""A mechanism of your own as data: a four-bar, driven by a torque, checked by its closed-form position."""

from math import acos, atan2, cos, hypot, pi, sin

import nullbody
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Revolute, Spherical


def rod(name, length):
    """A uniform thin rod along x from its joint, with mass mu per length."""
    moment = f"mu*{length}^3/12"
    return Body(name, mass=f"mu*{length}", centre=(f"{length}/2", 0, 0), inertia=(0, moment, moment))


four_bar = Mechanism(
    name="four_bar",
    bodies=(rod("crank", "a"), rod("coupler", "b"), rod("rocker", "c")),
    joints=(
        Revolute("crank", GROUND, "crank", ("q1",), axis="z"),
        Revolute("coupler", "crank", "coupler", ("q2",), Placement(("a", 0, 0)), axis="z"),
        Revolute("rocker", GROUND, "rocker", ("q3",), Placement(("d", 0, 0)), axis="z"),
    ),
    loops=(Spherical("pin", "coupler", "rocker", at=Placement(("b", 0, 0)), on=Placement(("c", 0, 0))),),
    actuators=(Actuator("torque", "q1"),),
    parameters=(
        Parameter("a", 0.2, "m", "crank"),
        Parameter("b", 0.5, "m", "coupler"),
        Parameter("c", 0.4, "m", "rocker"),
        Parameter("d", 0.6, "m", "base"),
        Parameter("mu", 1.5, "kg/m", "mass per length"),
    ),
    gravity=(0, -9.81, 0),
    home={"q1": 1.3, "q2": -0.9, "q3": 1.8},
)
equations = nullbody.derive(four_bar)
model = nullbody.build(equations)
start = nullbody.assemble(model, {"q1": 1.3})
motion = nullbody.simulate(model, start, 3.0, u=lambda t, x: [2.0 - 0.5 * x.v[0]])  # a motor with a falling torque
print(equations, motion, sep="\n")
print("crank turned by", round((motion["q1"][-1] - 1.3) / (2 * pi), 2), "turns; left out:", *equations.redundant)

a, b, c, d, _ = model.parameters.values()
for q1, q3 in zip(motion["q1"], motion["q3"], strict=True):
    x, y = a * cos(q1) - d, a * sin(q1)  # crank pin seen from the rocker's pivot
    r = hypot(x, y)
    wanted = atan2(y, x) - acos((c * c + r * r - b * b) / (2 * c * r))  # the rocker's angle, this branch
    assert abs((q3 - wanted + pi) % (2 * pi) - pi) < 1e-9
assert equations.redundant == ("pin z",) and motion.outcome.ok
