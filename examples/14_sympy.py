"""Equations of your own from SymPy: a bead on a cycloid, whose period does not depend on how far it swings."""

from math import pi, sqrt

import numpy as np
import sympy

import nullbody

x, y, phi, R, m, g = sympy.symbols("x y phi R m g")  # what the mechanism names so, below
b = nullbody.MechanismBuilder("tautochrone")
b.parameter("R", 0.25, "m", "radius of the wheel that draws the cycloid")
b.parameter("m", 0.1, "kg", "mass of the bead")
b.parameter("g", 9.81, "m/s^2", "gravity, along -y")
b.point_mass("bead", "m")
b.planar("plane", "ground", "bead", names=("x", "y", "phi"))  # phi is the wheel's angle here
b.holonomic("wire", [x - R * (phi + sympy.sin(phi)), y - R * (1 - sympy.cos(phi))])
b.energy("weight", potential=m * g * y)
mechanism = b.build()
model = nullbody.build(nullbody.derive(mechanism, independent=("phi",)))
print(mechanism, model.mobility, sep="\n")

exact = 4 * pi * sqrt(0.25 / 9.81)
bottom = nullbody.Event("bottom", lambda t, state: state["phi"], direction=-1, terminal=True)
periods = []
for start in (0.1, 1.0, 2.0, 3.0):
    half = nullbody.simulate(model, nullbody.assemble(model, {"phi": start}), 3.0, events=[bottom])
    periods.append(4 * half.t[-1])
    print(f"from {start} rad: period {periods[-1]:.12f} s, fastest {np.hypot(*half.q_dot[-1, :2]):.4f} m/s")
print(f"Huygens 1673:     period {exact:.12f} s = 4 pi sqrt(R/g)")

assert np.allclose(periods, exact, rtol=1e-9)
