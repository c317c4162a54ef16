"""What the builder and derive refuse by name: meaningless sizes, signs, equations and loads."""

import math
from typing import Any

import numpy as np
import pytest

import nullbody
from nullbody.errors import ExpressionError, InputError, MechanismError, NullbodyError, UnknownName


def arm() -> nullbody.MechanismBuilder:
    b = nullbody.MechanismBuilder("arms", gravity=(0, -9.81, 0))
    b.rod("a", 1.0, 0.4)
    b.rod("b", 1.0, 0.4)
    b.revolute("q", "ground", "a")
    b.revolute("q2", "a", "b", at=(0.4, 0, 0))
    return b


@pytest.mark.parametrize("residual", ["q - 1", "1", "sin(q) + 2", "0*q_dot + 1"])
def test_nonholonomic_equations_without_rates(residual: str) -> None:
    b = arm()
    b.nonholonomic("h", residual)
    with pytest.raises(MechanismError, match="'h 1' has no rate in it"):
        nullbody.derive(b.build())


def test_nonholonomic_equations_that_contradict() -> None:
    b = arm()
    b.nonholonomic("h", ["q_dot - q2_dot - 1", "q_dot - q2_dot - 2"])
    with pytest.raises(MechanismError, match=r"'h .' asks for a motion that the other equations do not allow"):
        nullbody.derive(b.build())


def test_nonholonomic_equations_that_repeat_are_one() -> None:
    b = arm()
    b.nonholonomic("h", ["q_dot - q2_dot - 1", "2*q_dot - 2*q2_dot - 2"])
    assert nullbody.derive(b.build()).mobility.nv == 1


def test_a_sign_that_is_no_word() -> None:
    with pytest.raises(UnknownName, match="positive"):
        arm().parameter("w", 1.0, sign="postive")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("method", "given"),
    [
        ("rod", (1.0, -0.4)),
        ("rod", (1.0, 0.4, "x", -0.1)),
        ("disc", (1.0, -0.1)),
        ("cylinder", (1.0, 0.1, -0.2)),
        ("box", (1.0, (0.1, -0.1, 0.1))),
        ("sphere", (1.0, -0.1)),
    ],
)
def test_negative_sizes(method: str, given: tuple[Any, ...]) -> None:
    with pytest.raises(MechanismError, match="must not be negative"):
        getattr(arm(), method)("new", *given)


@pytest.mark.parametrize("axis", [np.array([0, 0, 1]), math.nan, (0, 0, 1), None])
def test_axes_of_bodies(axis: object) -> None:
    with pytest.raises(MechanismError, match=r"has the axis .* choose one of"):
        arm().rod("new", 1.0, 0.4, axis=axis)  # type: ignore[arg-type]


@pytest.mark.parametrize("mass", [1e308, 5e-324])
def test_sizes_beyond_all_bounds(mass: float) -> None:
    with pytest.raises(ExpressionError, match="is no size of anything"):
        arm().rod("new", mass, 0.4)


def test_a_damper_whose_points_coincide() -> None:
    b = arm()
    b.spring("d", "ground", "a", stiffness=0, damping=2.0)
    with pytest.raises(MechanismError, match="the load 'd' divides by what is zero in every configuration"):
        nullbody.derive(b.build())


def test_a_driver_without_a_value_at_the_start() -> None:
    b = arm()
    b.driver("d", "q", "1/t")
    model = nullbody.build(nullbody.derive(b.build()))
    with pytest.raises(NullbodyError):
        nullbody.assemble(model, {})
    assert nullbody.assemble(model, {}, t=2.0)["q"] == pytest.approx(0.5)


@pytest.mark.parametrize("t", [math.nan, "a", None, math.inf])
def test_a_time_that_is_no_number(t: Any) -> None:
    model = nullbody.build(nullbody.derive(arm().build()))
    with pytest.raises(InputError, match="the time t must be a finite number"):
        nullbody.assemble(model, {"q": 0.1}, t=t)


def test_a_long_chain_of_parameters() -> None:
    b = arm()
    b.parameter("p0", 1.0)
    for k in range(1, 1500):
        b.parameter(f"p{k}", f"p{k - 1}")
    b.parameter("first", "p1499 + 1")
    assert b.build().values()["first"] == 2


def test_numbers_that_grow_without_limit() -> None:
    long = "+".join(f"1/(1.{k}e300^64-{k})" for k in range(10, 180))
    with pytest.raises(ExpressionError, match="the numbers become too long"):
        arm().rod("new", long, 0.4)
