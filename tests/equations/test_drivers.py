"""Drivers that ask for what the loops hold: refused where they are met first, in derive."""

import pytest

import nullbody
from nullbody.errors import AssemblyError, MechanismError
from nullbody.mechanism import Mechanism


def driven(**motions: str) -> Mechanism:
    """A four-bar with drivers on any of its angles."""
    b = nullbody.MechanismBuilder("driven", gravity=(0, 0, -9.81))
    for name, length in (("crank", 0.4), ("coupler", 1.0), ("rocker", 0.9)):
        b.rod(name, 1.0, length)
    b.revolute("A", "ground", "crank", axis="y")
    b.revolute("B", "crank", "coupler", at=(0.4, 0, 0), axis="y")
    b.revolute("C", "ground", "rocker", at=(0.8, 0, 0), axis="y")
    b.revolute("D", "coupler", "rocker", at=(1.0, 0, 0), on=(0.9, 0, 0), axis="y")
    b.home(A=-1.0, B=0.5, C=-1.5)
    for coordinate, motion in motions.items():
        b.driver(f"drive_{coordinate}", coordinate, motion)
    return b.build()


def rocker_angle() -> float:
    model = nullbody.build(nullbody.derive(driven(A="-1 + 0.3*t")))
    return float(nullbody.assemble(model, {})["C"])


@pytest.mark.parametrize("motion", ["+ 0.1*t", "+ 0.1*t^4", "", "+ sin(t)^3"])
def test_a_second_driver_that_contradicts_the_first_is_named(motion: str) -> None:
    with pytest.raises(MechanismError, match=r"'drive_. drive' asks for a motion that the other equations"):
        nullbody.derive(driven(A="-1 + 0.3*t", C=f"{rocker_angle()!r} {motion}"))


def test_two_drivers_that_say_the_same_are_one() -> None:
    b = nullbody.MechanismBuilder("twice")
    b.rod("arm", 1.0, 0.4)
    b.revolute("A", "ground", "arm", axis="z")
    b.driver("d1", "A", "sin(2*t)")
    b.driver("d2", "A", "2*sin(t)*cos(t)")
    equations = nullbody.derive(b.build())
    assert equations.labels == ("d1 drive",)
    assert equations.mobility.nv == 0


def test_a_driver_that_starts_elsewhere_cannot_be_assembled() -> None:
    model = nullbody.build(nullbody.derive(driven(A="-1 + 0.3*t", C="-1.5")))
    with pytest.raises(AssemblyError, match=r"'drive_C drive' is open by 0\.2.* rad"):
        nullbody.assemble(model, {})


def test_rows_of_drivers_and_couplings_have_the_unit_of_their_coordinate() -> None:
    b = nullbody.MechanismBuilder("rack")
    b.rod("pinion", 1.0, 0.4)
    b.box("rack", 1.0, (0.1, 0.1, 0.1))
    b.revolute("turn", "ground", "pinion", axis="z")
    b.prismatic("slide", "ground", "rack", axis="x")
    b.coupling("mesh", "slide", "turn", 0.05)
    b.driver("feed", "turn", "t")
    assert b.build().holonomic_rows == (("mesh coupling", "m"), ("feed drive", "rad"))
