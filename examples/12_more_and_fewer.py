"""More equations than are needed; more inputs than degrees of freedom, and fewer."""

from dataclasses import replace

import numpy as np

import nullbody
from nullbody.mechanism import Actuator

# More equations: Bricard's loop of six bars moves although counting says that it cannot. One equation repeats others,
# but only where the loop is closed. It is found on closed configurations, named and left out.
bricard = nullbody.derive(nullbody.catalog.bricard())
print(bricard.mobility)
cube = nullbody.build(bricard)
swing = nullbody.simulate(cube, nullbody.assemble(cube, {"theta1": 0.0}), 10.0)
print(swing)

# More inputs: motors on crank and rocker of a four-bar. Inverse dynamics gives the inputs of least norm; any multiple
# of the null space of forces may be added: the motors then strain the bars against each other, nothing moves.
bars = nullbody.catalog.four_bar()
motors = (Actuator("on_crank", "theta1"), Actuator("on_rocker", "theta3"))
both = nullbody.build(nullbody.derive(replace(bars, actuators=motors), independent=("theta1",)))
state = nullbody.assemble(both, {"theta1": 1.0}, v=[2.0])
found = both.actuation(state, [0.5])
print("two motors:", found.u.round(3), "N m, strain along", found.null_space[:, 0].round(4))
strained = found.u + 100 * found.null_space[:, 0]
one = nullbody.build(nullbody.derive(bars, independent=("theta1",)))
alone = one.inverse_dynamics(one.state(state.q, state.v), [0.5])
print(f"the crank's motor alone would need {alone[0]:.3f} N m")

# Fewer inputs: a five-bar robot with one motor. What is missing is the residual; without it no motor does it.
robot = nullbody.catalog.five_bar()
lame = nullbody.build(nullbody.derive(replace(robot, actuators=robot.actuators[:1]), independent=("theta1", "theta2")))
arms = nullbody.assemble(lame, {"theta1": 2.0, "theta2": 1.0})
held = lame.actuation(arms, [0.0, 0.0])
print("to hold still:", held.u.round(4), "N m; feasible:", held.feasible, "; missing:", held.residual.round(4), "N m")
falls = lame.forward_dynamics(arms, [0.3])[lame.independent_columns]
possible = lame.actuation(arms, falls)
print("accelerations", falls.round(3), "are feasible:", possible.feasible, "with", possible.u.round(6), "N m")

assert bricard.mobility.nv == 1 and bricard.mobility.gruebler == 0 and swing.statistics.energy_drift < 1e-6
assert abs(both.forward_dynamics(state, strained)[0] - 0.5) < 1e-9 and np.linalg.norm(found.u) < abs(alone[0])
assert not held.feasible and possible.feasible and abs(possible.u[0] - 0.3) < 1e-12
