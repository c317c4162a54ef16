"""The builder: a double wishbone suspension, its camber curve, and a corrugated road under the tyre."""

import numpy as np

import nullbody
from nullbody.kinematics import sweep

b = nullbody.MechanismBuilder("suspension", gravity=(0, 0, -9.81), own="angles")  # x ahead, y outwards, z up
b.parameter("k", 60e3, "N/m", "spring")
b.parameter("c", 4e3, "N s/m", "damper")
b.parameter("kt", 200e3, "N/m", "tyre")
b.parameter("z0", 0.34, "m", "height of the wheel's centre where the tyre carries nothing")
b.parameter("h", 0.01, "m", "amplitude of the road", "non-negative")
b.parameter("w", 40.0, "1/s", "frequency of the road")

b.rod("lower", mass=2.0, length=0.40, axis="y", radius=0.02)
b.rod("upper", mass=1.5, length=0.30, axis="y", radius=0.02)
b.body("knuckle", mass=20.0, inertia=(0.4, 0.8, 0.4))  # with the wheel; its frame lies in the wheel's centre
b.revolute("lower_hinge", "ground", "lower", at=(0, 0.30, 0.20), axis="x")  # the chassis is the ground here
b.revolute("upper_hinge", "ground", "upper", at=(0, 0.36, 0.45), axis="x")
b.spherical("lower_ball", "lower", "knuckle", at=(0, 0.40, 0), on=(0, -0.06, -0.12), coordinates="body")
b.spherical("upper_ball", "upper", "knuckle", at=(0, 0.30, 0), on=(0, -0.10, 0.13))
b.distance("tie_rod", "ground", "knuckle", length=0.37, at=(-0.12, 0.32, 0.25), on=(-0.12, -0.07, -0.07))
b.spring("strut", "ground", "lower", stiffness="k", length=0.485, damping="c", at=(0, 0.42, 0.55), on=(0, 0.28, 0))
b.wrench("tyre", "knuckle", force=(0, 0, "kt*(z0 + h*sin(w*t) - knuckle_z)"))
b.actuator("jack", "knuckle_z")  # a force under the wheel, for the statics
b.home(knuckle_y=0.76, knuckle_z=0.32)  # a rough guess: `coordinates="body"` gave the knuckle x, y, z and three angles
model = nullbody.build(nullbody.derive(b.build()))
print(model, model.mobility, sep="\n")

print("  z [mm]   camber [deg]   toe [deg]   jack [N]")
states = sweep(model, [{"knuckle_z": 0.32 + z} for z in np.linspace(-0.05, 0.05, 5)])
for state in states:
    camber, toe = np.degrees([-state["knuckle_psi"], state["knuckle_phi"]])  # negative: the top leans inwards
    jack = model.inverse_dynamics(state, [0.0])[0]
    print(f"{1000 * (state['knuckle_z'] - 0.32):8.1f}{camber:15.3f}{toe:12.3f}{jack:11.1f}")

smooth = nullbody.simulate(model.replace(h=0), nullbody.assemble(model, {"knuckle_z": 0.33}), 3.0)
rest = smooth.state(3.0)
print(f"on a smooth road it comes to rest at z = {rest['knuckle_z']:.5f} m")
for w in (10, 40, 80, 160):
    motion = nullbody.simulate(model.replace(w=w), rest, 3.0, t0=0, samples=3001)
    moves = 500 * np.ptp(motion["knuckle_z"][2000:])
    print(f"w = {w:3} rad/s: the wheel moves by {moves:5.2f} mm, the road by 10 mm")

# A second road: Lagrange multipliers in all coordinates. And at rest nothing is left for the jack to carry.
nullbody.verify.compare(model, engines=["multipliers"], states=10).check()
assert abs(model.replace(h=0).inverse_dynamics(rest, [0.0])[0]) < 1e-6
