from __future__ import annotations

import math
from typing import Any

import pytest

from nullbody.errors import ExpressionError, MechanismError, ParameterError, UnknownName
from nullbody.mechanism import (
    Actuator,
    Body,
    Free,
    Mechanism,
    Parameter,
    Placement,
    Prismatic,
    Revolute,
    Rotation,
    Spherical,
)

LENGTH = Parameter("r", 0.3, "m", "radius")
SLIDE = Prismatic("slide", "ground", "cart", ("s",))
SWING = Revolute("swing", "cart", "arm", ("angle",), Placement(("r", 0, 0)), axis="y")


def mechanism(**changes: Any) -> Mechanism:
    """A cart with an arm that a loop holds, with some parts exchanged."""
    parts: dict[str, Any] = {
        "name": "cart",
        "bodies": (Body("cart", 1), Body("arm", "r", ("r/2", 0, 0), ("r", "r", "r"))),
        "joints": (SLIDE, SWING),
        "loops": (Spherical("pin", "arm", "ground", at=Placement(("r", 0, 0)), on=Placement((0, 0, 1))),),
        "actuators": (Actuator("push", "s"),),
        "parameters": (LENGTH,),
        "home": {"s": "2*r"},
    }
    return Mechanism(**{**parts, **changes})


def body(**changes: Any) -> tuple[Body, ...]:
    """The bodies with another arm."""
    return (Body("cart", 1), Body(**{"name": "arm", "mass": 1, "inertia": (1, 1, 1), **changes}))


def test_names_in_the_order_of_the_joints() -> None:
    made = mechanism()
    assert made.coordinates == ("s", "angle")
    assert made.units == {"s": "m", "angle": "rad"}
    assert (made.inputs, made.actuated) == (("push",), ("s",))


def test_parents_come_before_children_whatever_the_order() -> None:
    assert [joint.name for joint in mechanism(joints=(SWING, SLIDE)).tree_order()] == ["slide", "swing"]
    assert mechanism(joints=(SWING, SLIDE)).coordinates == ("angle", "s")


NAMES = {
    "two bodies": ({"bodies": (Body("cart", 1), Body("arm", 1), Body("arm", 1))}, "body name 'arm' is used 2 times"),
    "two joints": (
        {"joints": (SLIDE, Revolute("slide", "cart", "arm", ("angle",)))},
        "joint or constraint name 'slide' is used 2",
    ),
    "joint and loop": ({"loops": (Spherical("slide", "arm", "ground"),)}, "'slide' is used 2"),
    "two coordinates": ({"joints": (SLIDE, Revolute("swing", "cart", "arm", ("s",)))}, "name 's' is used 2 times"),
    "coordinate and parameter": ({"parameters": (LENGTH, Parameter("s", 1.0))}, "name 's' is used 2 times"),
    "coordinate and input": ({"actuators": (Actuator("s", "s"),)}, "name 's' is used 2 times"),
    "two parameters": ({"parameters": (LENGTH, LENGTH)}, "name 'r' is used 2 times"),
    "a rate as a parameter": ({"parameters": (LENGTH, Parameter("s_dot", 1.0))}, "'s_dot' cannot be a name"),
    "a rate as an input": ({"actuators": (Actuator("s_ddot", "s"),)}, "'s_ddot' cannot be a name"),
    "the ground as a body": ({"bodies": (Body("ground", 1),)}, "'ground' cannot name a body"),
    "a function as a parameter": ({"parameters": (LENGTH, Parameter("sin", 1.0))}, "'sin' cannot name"),
    "time as a parameter": ({"parameters": (LENGTH, Parameter("t", 1.0))}, "'t' cannot name"),
    "a digit first": ({"parameters": (LENGTH, Parameter("2r", 1.0))}, "'2r' cannot name"),
    "a space": ({"parameters": (LENGTH, Parameter("r 2", 1.0))}, "'r 2' cannot name"),
    "an accent": ({"parameters": (LENGTH, Parameter("é", 1.0))}, "'é' cannot name"),
    "too few coordinates": (
        {"joints": (SLIDE, Free("swing", "cart", "arm", ("x", "y")))},
        "6 coordinates, 2 were named",
    ),
}

TREE = {
    "no joint": ({"joints": (SLIDE,), "loops": ()}, "'arm' must be the child of exactly one tree joint, not of 0"),
    "two parents": (
        {"joints": (SLIDE, SWING, Revolute("again", "ground", "arm", ("other",)))},
        "exactly one tree joint, not of 2; joints that close loops belong in `loops`",
    ),
    "the ground as a child": (
        {"joints": (SLIDE, SWING, Revolute("under", "arm", "ground", ("other",)))},
        "ground cannot be the child",
    ),
    "a circle": (
        {"joints": (Prismatic("slide", "arm", "cart", ("s",)), SWING)},
        "not connected to the ground by tree joints: cart, arm",
    ),
}


def arm(*rotations: Rotation, axis: Any = "z", position: Any = (0, 0, 0)) -> dict[str, Any]:
    """The joints with another arm joint."""
    return {"joints": (SLIDE, Revolute("swing", "cart", "arm", ("angle",), Placement(position, rotations), axis=axis))}


SHAPES = {
    "an axis": (arm(axis="w"), "'swing' has the axis 'w'"),
    "an axis of a rotation": (arm(Rotation("X", 30)), "axis 'X'"),
    "no angle": (arm(Rotation("x")), "either degrees or radians"),
    "two angles": (arm(Rotation("x", 30, 1)), "either degrees or radians"),
    "degrees as text": (arm(Rotation("x", "r")), "number of degrees"),
    "a short position": (arm(position=(0, 0)), "three components"),
    "a short centre": ({"bodies": body(centre=(0, 0))}, "body 'arm' needs three components"),
    "a scalar gravity": ({"gravity": -9.81}, "gravity needs three components"),
    "a long point": (
        {"loops": (Spherical("pin", "arm", "ground", at=Placement((0, 0, 0, 0))),)},
        "loop 'pin' needs three",
    ),
    "two moments": ({"bodies": body(inertia=(1, 1))}, "'arm' needs 3 or 6 inertia entries, not \\(1, 1\\)"),
}


@pytest.mark.parametrize("case", [*NAMES, *TREE, *SHAPES])
def test_a_mechanism_that_makes_no_sense_is_refused(case: str) -> None:
    changes, message = {**NAMES, **TREE, **SHAPES}[case]
    with pytest.raises(MechanismError, match=message):
        mechanism(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joints": (SLIDE, Revolute("swing", "carts", "arm", ("angle",)))}, "joint 'swing': .*mean 'cart'"),
        ({"joints": (SLIDE, SWING, Revolute("more", "cart", "legs", ("other",)))}, "no body .*'legs'"),
        ({"loops": (Spherical("pin", "arms", "ground"),)}, "joint 'pin': .*mean 'arm'"),
        ({"actuators": (Actuator("push", "angel"),)}, "actuator 'push': .*mean 'angle'"),
        ({"home": {"angel": 1}}, "home: .*mean 'angle'"),
        ({"end_effector": "harm"}, "end effector.*mean 'arm'"),
        ({"bodies": body(mass="R")}, "body 'arm': there is no parameter"),
        ({"gravity": (0, "-g", 0)}, "'g'"),
        ({"parameters": (LENGTH, Parameter("d", "s"))}, "the default of d: "),
    ],
)
def test_unknown_names_are_named_with_a_suggestion(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(UnknownName, match=message):
        mechanism(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bodies": body(mass="r +")}, "body 'arm': the expression ends too early"),
        ({"bodies": body(mass="__import__('os')")}, "body 'arm'"),
        ({"bodies": body(mass=None)}, "body 'arm': expected a number"),
        ({"bodies": body(mass=math.nan)}, "body 'arm': a number must be finite"),
        ({"bodies": body(centre=("2**10**9", 0, 0))}, "body 'arm'"),
        ({"loops": (Spherical("pin", "arm", "ground", at=Placement(("1/0", 0, 0))),)}, "loop 'pin': division by zero"),
        ({"home": {"s": "r/(1 - 1)"}}, "home: division by zero"),
    ],
)
def test_a_bad_expression_is_refused_with_its_place(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ExpressionError, match=message):
        mechanism(**changes)


def test_an_expression_may_vanish_below_a_fraction_for_some_values() -> None:
    made = mechanism(parameters=(LENGTH, Parameter("d", 0.1)), bodies=body(mass="1/(r - d)"))
    assert made.values() == {"r": 0.3, "d": 0.1}
    with pytest.raises(ParameterError, match="body 'arm': division by zero"):
        made.values({"d": 0.3})


@pytest.mark.parametrize(
    ("inertia", "what"),
    [
        ((1, 1, 3), "1, 1, 3"),
        ((-1, 1, 1), "-1, 1, 1"),
        ((0, 0, "r"), "0, 0, 0.3"),
        ((1, 1, 1, 2, 0, 0), "-1, 1, 3"),
    ],
)
def test_an_impossible_inertia_is_refused(inertia: tuple[Any, ...], what: str) -> None:
    with pytest.raises(ParameterError, match=f"'arm' would have the principal moments of inertia {what} kg m"):
        mechanism(bodies=body(inertia=inertia)).values()


@pytest.mark.parametrize("inertia", [(0, 0, 0), (0, 1, 1), (1, 1, 2), (2, 2, 2, 0.5, -0.5, 0.1)])
def test_points_rods_and_discs_are_possible(inertia: tuple[Any, ...]) -> None:
    assert mechanism(bodies=body(inertia=inertia)).values() == {"r": 0.3}


def test_a_negative_or_infinite_mass_is_refused() -> None:
    with pytest.raises(ParameterError, match=r"'arm' would have the mass -0\.3 kg"):
        mechanism(bodies=body(mass="-r")).values()
    with pytest.raises(ParameterError, match=r"'arm'.*not finite"):
        mechanism(bodies=body(mass="r^4")).values({"r": 1e200})


def test_home_follows_the_parameters_and_is_0_where_not_given() -> None:
    made = mechanism()
    assert made.home_values(made.values({"r": 0.5})) == {"s": 1.0, "angle": 0.0}


def test_nothing_can_be_changed_afterwards() -> None:
    with pytest.raises(AttributeError):
        mechanism().name = "other"
