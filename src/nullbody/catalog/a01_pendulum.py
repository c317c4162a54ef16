"""The pendulum in Cartesian coordinates (IFToMM benchmark A01).

    q = [x | y]

The frame has y up, the pivot is its origin. A massless carriage slides along x and carries the point mass along y;
the weightless bar is a constant distance, so every pose where x or y alone determines the motion is passed: neither
x (where the bar is vertical) nor y (where it is horizontal) is an independent coordinate all the way round.
"""

from __future__ import annotations

from nullbody.catalog.start import Start
from nullbody.mechanism import GROUND, Actuator, Body, Distance, Mechanism, Parameter, Prismatic

__all__ = ["a01_pendulum", "starts"]

_PARAMETERS = (
    Parameter("L", 1.0, "m", "length of the bar"),
    Parameter("m", 1.0, "kg", "point mass"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
)


def a01_pendulum(**values: float) -> Mechanism:
    """The simple pendulum: x^2 + y^2 = L^2, m x'' = -lambda x / L, m y'' = -m g - lambda y / L.

    lambda is the bar's force on the mass towards the pivot [N]. Home is the horizontal bar, x = -L. Inputs: a force on
    the mass along x and one along y, more than its one degree of freedom needs.

    Source: IFToMM library of computational benchmark problems, A01. Exact: sin(theta/2) = k sn(K(k) + sqrt(g/L) t) from
    rest at x = -L, with k = sin(pi/4) and theta from the downward vertical.

    Args:
        values: parameters that differ from the benchmark's: L [m], m [kg], g [m/s^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="a01_pendulum",
        bodies=(Body("carriage"), Body("mass", "m")),
        joints=(
            Prismatic("slide_x", GROUND, "carriage", ("x",), axis="x"),
            Prismatic("slide_y", "carriage", "mass", ("y",), axis="y"),
        ),
        loops=(Distance("bar", GROUND, "mass", length="L"),),
        actuators=(Actuator("Fx", "x"), Actuator("Fy", "y")),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        home={"x": "-L"},
        end_effector="mass",
    )
    return mechanism.with_parameters(**values)


def starts(**values: float) -> dict[str, Start]:
    """`horizontal`: at rest at x = -L."""
    return {"horizontal": Start(a01_pendulum(**values), duration=10.0, source="IFToMM A01")}
