"""The Chaplygin sleigh: a rigid body on a plane that stands on one blade, the simplest nonholonomic mechanism.

    q = [x y phi]

x, y is where the blade touches the horizontal plane, phi the heading of the blade. The centre of mass is at the
distance a ahead of it, along the blade.
"""

from __future__ import annotations

from nullbody.catalog.start import Start
from nullbody.mechanism import GROUND, Actuator, Body, KnifeEdge, Mechanism, Parameter, Planar

__all__ = ["chaplygin_sleigh", "starts"]

_PARAMETERS = (
    Parameter("a", 0.1, "m", "distance of the centre of mass ahead of the blade", "any"),
    Parameter("m", 1.0, "kg", "mass"),
    Parameter("I", 0.1, "kg m^2", "moment of inertia about the vertical through the centre of mass"),
)


def chaplygin_sleigh(**values: float) -> Mechanism:
    """The sleigh: -x' sin(phi) + y' cos(phi) = 0; input: a torque about the vertical.

    With the speed v along the blade and w = phi': v' = a w^2, (I + m a^2) w' = -m a v w. The multiplier is the force of
    the ground on the blade towards its left, m (v w + a w').

    Source: A. M. Bloch, Nonholonomic Mechanics and Control (2015), section 1.7. Exact: v = A tanh(k t + c),
    w = B sech(k t + c), A^2 = v0^2 + J w0^2 / m, B^2 = A^2 m / J, k = a B^2 / A, c = atanh(v0 / A), J = I + m a^2.

    Args:
        values: parameters that differ from the defaults: a [m], m [kg], I [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="chaplygin_sleigh",
        bodies=(Body("sleigh", "m", ("a", 0, 0), ("I/2", "I/2", "I")),),
        joints=(Planar("plane", GROUND, "sleigh", ("x", "y", "phi")),),
        constraints=(KnifeEdge("blade", "sleigh"),),
        actuators=(Actuator("torque", "phi"),),
        parameters=_PARAMETERS,
        end_effector="sleigh",
    )
    return mechanism.with_parameters(**values)


def starts(**values: float) -> dict[str, Start]:
    """`backwards`: blade behind the centre of mass in the end, but it starts backwards with 0.5 m/s, turning."""
    sleigh = chaplygin_sleigh(**values)
    return {
        "backwards": Start(sleigh, rates={"x": -0.5, "phi": 1.0}, duration=20.0, source="Bloch (2015), section 1.7")
    }
