"""Mechanisms with one of everything, for tests of the formats."""

from __future__ import annotations

from nullbody.mechanism import GROUND, Mechanism, MechanismBuilder, Placement, Rotation

__all__ = ["chain", "everything"]


def _body(builder: MechanismBuilder, name: str, k: int) -> None:
    builder.body(name, 1 + 0.1 * k, (0.1, -0.05 * k, 0.2), (0.3, 0.4, 0.5, 0.02, -0.03, 0.01 * k))


def _frame(k: int) -> Placement:
    return Placement((0.1 * k, -0.2, 0.3), (Rotation("x", degrees=30), Rotation("y", radians=0.2 * k - 0.7)))


def chain() -> Mechanism:
    """A chain and a branch of all joints that stand in trees, with turned frames and what MuJoCo knows of loads."""
    b = MechanismBuilder("chain", gravity=(0.3, -1, -9.81))
    for k, name in enumerate("abcdefg"):
        _body(b, name, k)
    b.universal("u", GROUND, "a", _frame(1), _frame(2), axis="-y", axis2="z")
    b.cylindrical("c", "a", "b", _frame(3), _frame(4), axis=(1, 2, 3))
    b.spherical("s", "b", "c", _frame(5), _frame(6))
    b.planar("p", "c", "d", _frame(7), _frame(8), axis="-x")
    b.free("f", "e", "b", _frame(9), _frame(1))
    b.free("g", "f", GROUND, _frame(2), _frame(3), attitude="angles")
    b.weld("w", "c", "g", _frame(4), _frame(5))
    b.coordinate_spring("one", "u_alpha", 3.0, 0.2, 0.7)
    b.coordinate_spring("other", "u_alpha", 2.0, -0.4)
    b.friction("oil", "c_s", 0, 0.6)
    b.spring("coil", "d", "f", 40, 0.3, 2.0, (0.1, 0, 0), (0, 0.2, 0))
    b.damper("dash", "e", GROUND, 1.5, on=(0, 0, 3))
    b.energy("rotor", 0, "0.25*p_alpha_dot^2/2")
    b.actuator("torque", "u_beta", (-2, "1/2"))
    return b.build()


def everything() -> Mechanism:
    """Every joint, constraint, load and kind of scalar that a model file can hold; it need not close."""
    b = MechanismBuilder("every thing: 1e-3", gravity=(0, "-g", 0.5))
    b.parameter("g", 9.81, "m/s^2", "gravity: it's 'strong'", "any")
    b.parameter("l", 0.4)
    b.parameter("m", "2*l^2", "kg", sign="non-negative")
    b.parameter("k", "1e-3", "N m/rad")
    for k, name in enumerate(("a", "b", "c", "d", "e", "on", "yes", "null", "h")):
        _body(b, name, k)
    b.point_mass("slider", "m/2", ("l", 1e-20, -1e99))
    b.revolute("shaft", GROUND, "a", Placement((0, 0, "l"), (Rotation("-x", degrees=-37.5),)), axis="-y", names="q1")
    b.prismatic("rail: x", GROUND, "slider", names="s")
    b.cylindrical("tube", "a", "b", on=Placement((0, 0, 0), (Rotation("z", radians="k/2"),)))
    b.universal("cross", "b", "c", axis="z", axis2="-x", names=("alpha", "beta"))
    b.spherical("ball", "c", "d")
    b.planar("table", "d", "e", axis="-x")
    b.free("fly", "on", "e")
    b.free("kite", "yes", attitude="angles", names=("n1", "n2", "n3", "n4", "n5", "n6"))
    b.weld("glue", "yes", "null", at=(0, 1, 0))
    b.screw("screw", "null", "h", lead=0.01)
    for kind in ("revolute", "prismatic", "cylindrical", "universal", "spherical", "planar", "weld"):
        getattr(b, kind)(f"loop {kind}", "a", "on", at=(0, 0, 1), loop=True)
    b.distance("rod", "a", "h", "l + 1", on=("l", 0, 0))
    b.point_on_line("line", "a", GROUND, axis="-z")
    b.point_on_plane("plane", GROUND, "d", at=Placement((1, 0, 0), (Rotation("y", degrees=45),)), axis="x")
    b.gear("gear", "q1", "tube_alpha", (20, 41), internal=True)
    b.rack("rack", "s", "q1", "-l/4", offset=0.3)
    b.coupling("belt", "beta", "alpha", 1.5)
    b.driver("drive", "q1", "0.2*sin(3*t) + k")
    b.rolling_disc("wheel", "yes", "l", Placement((0, 0, 0.1), (Rotation("x", 90),)), "z", (0, 0, -1))
    b.knife_edge("blade", "on", (0.1, 0, 0), "x")
    b.holonomic("mine", ["q1^2 - s", "alpha - t"])
    b.nonholonomic("slip", "q1_dot*sin(s) - s_dot")
    b.spring("coil", "a", "b", 100, "l/2", 3, (0, 0, 1), (0, "l", 0))
    b.damper("dash", GROUND, "b", 2.5)
    b.coordinate_spring("twist", "beta", "k", 0.1)
    b.friction("rub", "s", 2, "k", 0.01)
    b.wrench("push", "e", ("sin(t)", 0, 1), (0, "q1_dot", 0), (0, 0, "l"), "body")
    b.energy("well", "g*q1^2/2", "m*s_dot^2")
    b.actuator("u", "shaft", ("-l", 2))
    b.actuator("v", "s")
    b.home(q1="pi/3", s=1e-5, ball_e0="sqrt(2)/2", ball_e1=0.7071067811865476)
    b.end_effector("e")
    return b.build()
