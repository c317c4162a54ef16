"""The builder: joints in any order, names, coordinates of bodies, and every mistake by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import nullbody
from nullbody import ExpressionError, MechanismBuilder, MechanismError, ParameterError, UnknownName
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Coupling,
    Distance,
    Free,
    FreeQuaternion,
    Mechanism,
    Placement,
    Planar,
    Revolute,
    Spherical,
    Spring,
)


def slider_crank(order: int = 0, **choices: dict[str, Any]) -> Mechanism:
    """A planar slider-crank, its joints told in one of several orders, some from child to parent."""
    b = MechanismBuilder("slider_crank", gravity=(0, -9.81, 0), own="planar")
    r, l = b.parameter("r", 0.1, "m"), b.parameter("l", 0.35, "m")  # noqa: E741, a length
    b.rod("crank", 0.3, r)
    b.rod("rod", 0.5, l)
    b.point_mass("slider", 0.8)
    b.friction("rub", "rail", viscous=0.3)
    b.actuator("torque", "shaft")
    calls = [
        lambda: b.revolute("shaft", GROUND, "crank", **choices.get("shaft", {})),
        lambda: b.revolute("pin", "crank", "rod", at=(r, 0, 0), **choices.get("pin", {})),
        lambda: b.prismatic("rail", GROUND, "slider", axis="x", **choices.get("rail", {})),
        lambda: b.revolute("wrist", "rod", "slider", at=(l, 0, 0), **choices.get("wrist", {})),
    ]
    for k in range(4):
        calls[(k + order) % 4]()
    b.home(shaft=0.8, rail=0.4)
    return b.build()


def accelerations(mechanism: Mechanism) -> tuple[float, float]:
    """Of the shaft and the slide, in one state under one torque."""
    model = nullbody.build(nullbody.derive(mechanism, ("shaft",)))
    state = nullbody.assemble(model, {"shaft": 0.8}, v={"shaft": 2.0})
    found = dict(zip(model.coordinates, model.forward_dynamics(state, [1.5]), strict=True))
    return found["shaft"], found["rail"]


def test_order_and_direction_of_the_joints_do_not_matter() -> None:
    wanted = accelerations(slider_crank())
    for order in range(1, 4):
        assert accelerations(slider_crank(order)) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(
    ("choices", "count"),
    [
        ({"pin": {"loop": True}}, 3),
        ({"pin": {"tree": True}, "wrist": {"loop": True}}, 3),
        ({"pin": {"coordinates": "body"}}, 5),
        ({"pin": {"coordinates": "body"}, "wrist": {"loop": True}}, 5),
        ({"pin": {"loop": True}, "wrist": {"loop": True}}, 5),
    ],
)
def test_which_joint_closes_the_loop_does_not_matter(choices: dict[str, Any], count: int) -> None:
    made = slider_crank(**choices)
    assert len(made.coordinates) == count
    assert accelerations(made) == pytest.approx(accelerations(slider_crank()), rel=1e-11)


def test_joints_whose_coordinates_are_used_stand_in_the_tree() -> None:
    for order in range(4):
        assert {joint.name for joint in slider_crank(order).joints} >= {"shaft", "rail"}


def one_body(**options: Any) -> MechanismBuilder:
    builder = MechanismBuilder("m", **options)
    builder.body("a", 1, inertia=(1, 1, 1))
    return builder


def test_names_of_coordinates() -> None:
    b = one_body()
    for name in "bcdefg":
        b.body(name, 1, inertia=(1, 1, 1))
    b.revolute("turn", GROUND, "a")
    b.cylindrical("bar", "a", "b")
    b.universal("cross", "b", "c")
    b.spherical("ball", "c", "d")
    b.planar("table", "d", "e", axis="y", names=("u", "w", "turned"))
    b.free("float", "f", "e")
    b.free("fly", "g", attitude="angles")
    assert b.build().coordinates == (
        *("turn", "bar_s", "bar_alpha", "cross_alpha", "cross_beta", "ball_e0", "ball_e1", "ball_e2", "ball_e3"),
        *("u", "w", "turned", "float_x", "float_y", "float_z", "float_e0", "float_e1", "float_e2", "float_e3"),
        *("fly_x", "fly_y", "fly_z", "fly_psi", "fly_theta", "fly_phi"),
    )


@pytest.mark.parametrize(
    ("own", "kind", "names"),
    [
        ("quaternion", FreeQuaternion, ("a_x", "a_y", "a_z", "a_e0", "a_e1", "a_e2", "a_e3")),
        ("angles", Free, ("a_x", "a_y", "a_z", "a_psi", "a_theta", "a_phi")),
        ("planar", Planar, ("a_x", "a_y", "a_alpha")),
    ],
)
def test_a_body_that_only_rods_hold_has_coordinates_of_its_own(own: Any, kind: type, names: tuple[str, ...]) -> None:
    b = one_body(own=own)
    b.distance("rod", GROUND, "a", 0.5, on=(0.1, 0, 0))
    made = b.build()
    assert [type(joint) for joint in made.joints] == [kind]
    assert made.coordinates == names
    assert made.loops == (Distance("rod", GROUND, "a", (), Placement(), Placement((0.1, 0, 0)), length=0.5),)


def test_two_bodies_that_hang_on_rods_together_get_one_set_of_own_coordinates() -> None:
    b = one_body()
    b.body("b", 1, inertia=(1, 1, 1))
    b.free("drift", "a", "b")
    b.distance("rod", GROUND, "a", 0.5)
    made = b.build()
    assert [(joint.name, joint.parent, joint.child) for joint in made.joints] == [
        ("drift", "b", "a"),
        ("b", GROUND, "b"),
    ]


def test_ready_shapes() -> None:
    b = MechanismBuilder("shapes")
    b.parameter("m", 2.0, "kg")
    b.rod("rod", "m", 3, axis="-y")
    b.rod("round", 12, 2, radius=1)
    b.disc("disc", 4, 0.5, axis="x")
    b.cylinder("cylinder", 12, 1, 2, centre=(0, 0, 1))
    b.box("box", 12, (1, 2, 3))
    b.sphere("sphere", 5, 2)
    b.point_mass("point", 3, (1, 0, 0))
    for k, name in enumerate(("rod", "round", "disc", "cylinder", "box", "sphere", "point")):
        b.free(f"f{k}", name)
    rod, round_, disc, cylinder, box, sphere, point = b.build().bodies
    assert (rod.centre, rod.inertia) == ((0, -1.5, 0), ("m*3^2/12", 0, "m*3^2/12"))
    assert (round_.centre, round_.inertia) == ((1.0, 0, 0), (6.0, 7.0, 7.0))
    assert disc.inertia == (0.5, 0.25, 0.25)
    assert (cylinder.inertia, cylinder.centre) == ((7.0, 7.0, 6.0), (0, 0, 1))
    assert box.inertia == (13.0, 10.0, 5.0)
    assert sphere.inertia == (8.0, 8.0, 8.0)
    assert (point.mass, point.inertia) == (3, (0, 0, 0))


def geared(**changes: Any) -> MechanismBuilder:
    b = MechanismBuilder("gears")
    for name in ("small", "large", "bar", "nut"):
        b.disc(name, 1, 0.1)
    b.revolute("first", GROUND, "small")
    b.revolute("second", GROUND, "large", at=(0.3, 0, 0))
    b.prismatic("slide", GROUND, "bar", axis="x")
    b.screw("spindle", "bar", "nut", lead=0.002)
    b.gear("mesh", **{"driven": "second", "driver": "first", "teeth": (40, 20), **changes})
    return b


def test_gears_racks_and_screws_are_couplings() -> None:
    b = geared(offset=0.1)
    b.gear("ring", "second", "first", (40, 20), internal=True)
    b.rack("teeth", "slide", "first", radius="0.05")
    assert b.build().constraints == (
        Coupling("spindle_lead", "spindle_s", "spindle_alpha", "0.002/(2*pi)"),
        Coupling("mesh", "second", "first", "-20/40", 0.1),
        Coupling("ring", "second", "first", "20/40"),
        Coupling("teeth", "slide", "first", "0.05"),
    )
    with pytest.raises(MechanismError, match=r"gear 'mesh' couples coordinates in rad and rad, but 'slide' is in m"):
        geared(driven="slide").build()


def test_custom_constraints_and_energies_of_sympy() -> None:
    sympy = pytest.importorskip("sympy")
    b = one_body()
    b.planar("table", GROUND, "a", names=("x", "y", "psi"))
    x, y, psi, x_dot, y_dot = sympy.symbols("x y psi x_dot y_dot")
    b.parameter("k", 3.0, "N/m")
    b.nonholonomic("blade", x_dot * sympy.sin(psi) - y_dot * sympy.cos(psi))
    b.holonomic("circle", x**2 + y**2 - 1)
    b.energy("well", potential=sympy.Symbol("k") * (x - sympy.Rational(1, 3)) ** 2 / 2)
    made = b.build()
    assert made.nonholonomic_rows == (("blade 1", "m/s"),)
    model = nullbody.build(nullbody.derive(made))
    assert len(model.independent) == 1


def test_home_of_a_ball_that_is_turned_round_keeps_its_meaning() -> None:
    b = one_body()
    b.spherical("ball", "a", GROUND, at=(1, 0, 0))
    b.home(ball_e0=0.8, ball_e3=0.6)
    made = b.build()
    assert made.home_values({}) == {"ball_e0": 0.8, "ball_e1": 0, "ball_e2": 0, "ball_e3": -0.6}
    assert made.joints == (
        Spherical("ball", GROUND, "a", ("ball_e0", "ball_e1", "ball_e2", "ball_e3"), on=Placement((1, 0, 0))),
    )


def test_home_of_joints_that_close_loops_is_left_out() -> None:
    made = slider_crank(pin={"loop": True})
    b = one_body()
    b.revolute("one", GROUND, "a")
    b.revolute("two", GROUND, "a", loop=True)
    b.home(one=1, two=2)
    assert b.build().home == {"one": 1}
    assert made.home == {"shaft": 0.8, "rail": 0.4}


def test_a_builder_ends_with_build_but_not_with_a_failure() -> None:
    b = one_body()
    with pytest.raises(MechanismError):
        b.build()
    b.revolute("shaft", GROUND, "a")
    assert b.build().coordinates == ("shaft",)
    for call in (b.build, lambda: b.body("b"), lambda: b.home(shaft=1), lambda: b.end_effector("a")):
        with pytest.raises(MechanismError, match="is at its end: start a new one"):
            call()


def test_springs_dampers_and_inputs() -> None:
    b = one_body()
    b.revolute("shaft", GROUND, "a", names="q")
    b.spring("coil", GROUND, "a", 100, 0.2, at=(0, 0, 1), on=np.array([0.1, 0, 0]))
    b.damper("dash", "a", GROUND, 3)
    b.coordinate_damper("brake", "shaft", 0.1)
    b.wrench("push", "a", force=(0, "2*sin(t)*q_dot", 0))
    b.actuator("motor", "shaft", limits=("-1", 1))
    made = b.build()
    assert made.loads[0] == Spring("coil", GROUND, (0, 0, 1), "a", (0.1, 0, 0), 100, 0.2, 0)
    assert [load.coordinates for load in made.loads[2:]] == [("q",), ()]
    assert made.actuators == (Actuator("motor", "q", ("-1", 1)),)


def wrong(call: str, **arguments: Any) -> Any:
    """A case: one more call on a cart with a pendulum, then build."""
    return call, arguments


MISTAKES: dict[str, tuple[Any, type[Exception], str]] = {
    "body twice": (wrong("body", name="a"), MechanismError, "body name 'a' is taken"),
    "joint twice": (
        wrong("weld", name="shaft", parent="a", child=GROUND),
        MechanismError,
        "joint name 'shaft' is taken",
    ),
    "constraint like a joint": (
        wrong("driver", name="shaft", coordinate="shaft", motion=1),
        MechanismError,
        "is taken",
    ),
    "parameter twice": (wrong("parameter", name="r", default=1), MechanismError, "parameter name 'r' is taken"),
    "no name": (wrong("body", name=""), MechanismError, "the name of a body is a text"),
    "unknown body": (wrong("revolute", name="j", parent="A", child=GROUND), UnknownName, "joint 'j'.*mean 'a'"),
    "itself": (wrong("revolute", name="j", parent="a", child="a"), MechanismError, "joins body 'a' with itself"),
    "lost body": (
        wrong("body", name="b"),
        MechanismError,
        r"not connected to the ground by any joint: b; .*free\('b_free'",
    ),
    "axis": (wrong("revolute", name="j", parent="a", child=GROUND, axis="w"), MechanismError, "'j' has the axis 'w'"),
    "two roles": (
        wrong("weld", name="j", parent="a", child=GROUND, tree=True, loop=True),
        MechanismError,
        "cannot both",
    ),
    "names of a rod": (
        wrong("distance", name="j", parent="a", child=GROUND, length=1, names="d"),
        MechanismError,
        "can only close a loop and has no coordinates",
    ),
    "too many names": (
        wrong("revolute", name="j", parent="a", child=GROUND, names=("p", "q")),
        MechanismError,
        r"has 1 coordinates \(j\), 2 were named",
    ),
    "coordinates": (
        wrong("weld", name="j", parent="a", child=GROUND, coordinates="own"),
        MechanismError,
        "'relative' or 'body'",
    ),
    "free loop": (wrong("free", name="j", child="a", loop=True), MechanismError, "can close no loop"),
    "free twice": (wrong("free", name="j", child="a"), MechanismError, "another joint in the tree|closes a circle"),
    "point": (wrong("spherical", name="j", parent="a", child=GROUND, at=(1, 2)), MechanismError, "three components"),
    "a lost coordinate": (
        wrong("actuator", name="u", coordinate="second"),
        MechanismError,
        "actuator 'u' needs a coordinate of joint 'second', which closes a loop and has none: give it tree=True",
    ),
    "a lost coordinate in a text": (
        wrong("energy", name="e", potential="second^2"),
        MechanismError,
        "load 'e' needs a coordinate of joint 'second'",
    ),
    "unknown coordinate": (wrong("actuator", name="u", coordinate="shafft"), UnknownName, "mean 'shaft'"),
    "unknown home": (wrong("home", values={"shafft": 1}), UnknownName, "home: .*mean 'shaft'"),
    "unknown end effector": (wrong("end_effector", body="A"), UnknownName, "end effector.*mean 'a'"),
    "unit": (wrong("parameter", name="d", default=3, unit="mm"), MechanismError, "'mm', and 'mm' is no SI unit"),
    "degrees": (wrong("parameter", name="d", default=3, unit="deg"), MechanismError, "no SI unit"),
    "expression": (
        wrong("driver", name="d", coordinate="shaft", motion="__import__('os')"),
        ExpressionError,
        "driver 'd'",
    ),
    "one limit": (wrong("actuator", name="u", coordinate="shaft", limits=(1,)), MechanismError, "two limits"),
    "limits": (wrong("actuator", name="u", coordinate="shaft", limits=(1, -1)), ParameterError, "wrong order"),
    "rod without length": (wrong("distance", name="j", parent="a", child=GROUND, length=0), ParameterError, "length"),
    "inertia": (wrong("body", name="c", inertia=(1, 1)), MechanismError, "3 or 6 inertia entries"),
    "teeth": (wrong("gear", name="g", driven="shaft", driver="shaft", teeth=(1,)), MechanismError, "numbers of teeth"),
    "no residual": (wrong("holonomic", name="h", residuals=[]), MechanismError, "at least one residual"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_every_mistake_has_a_name(case: str) -> None:
    (call, arguments), error, message = MISTAKES[case]
    b = one_body()
    b.parameter("r", 0.1, "m")
    b.revolute("shaft", GROUND, "a", tree=True)
    b.revolute("second", GROUND, "a", axis="z", loop=True)

    def told() -> None:
        getattr(b, call)(**arguments)
        b.build()

    with pytest.raises(error, match=message):
        told()


@pytest.mark.parametrize("mass", [-1, "-r"])
def test_what_is_not_physical_is_refused(mass: Any) -> None:
    b = one_body()
    b.parameter("r", 0.1, "m")
    b.body("b", mass, inertia=(1, 1, 1))
    b.revolute("shaft", GROUND, "a")
    b.revolute("pin", "a", "b")
    with pytest.raises(ParameterError, match="'b' would have the mass"):
        b.build()


def test_a_planar_joint_that_would_change_its_meaning_is_refused_where_that_matters() -> None:
    for used in (False, True):
        b = one_body()
        b.planar("table", "a", GROUND)
        if used:
            b.actuator("push", "table_x")
            with pytest.raises(MechanismError, match=r"'table' are used by name.*exchange its parent and child"):
                b.build()
        else:
            (joint,) = b.build().joints
            assert (joint.parent, joint.child) == (GROUND, "a")


def test_a_joint_name_that_is_no_symbol_needs_names() -> None:
    b = one_body()
    b.revolute("joint 1", GROUND, "a")
    with pytest.raises(MechanismError, match="'joint 1'"):
        b.build()
    b = one_body()
    b.revolute("joint 1", GROUND, "a", names="q1")
    assert b.build().joints == (Revolute("joint 1", GROUND, "a", ("q1",)),)
