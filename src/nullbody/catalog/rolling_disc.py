"""A thin disc that rolls without slip on a horizontal plane: Euler's disc, the falling coin.

    q = [x y z | e0 e1 e2 e3]

The frame has z up, the plane is z = 0. x, y, z is the disc's centre; the Euler parameters turn the disc, whose axis n
is the x axis of its frame. At home it stands upright on the origin with n along x.
"""

from __future__ import annotations

from math import pi

from nullbody.catalog.start import Start
from nullbody.mechanism import GROUND, Actuator, Body, FreeQuaternion, Mechanism, Parameter, RollingDisc
from nullbody.typing import Scalar

__all__ = ["rolling_disc", "starts"]

_PARAMETERS = (
    Parameter("r", 0.5, "m", "radius"),
    Parameter("m", 1.0, "kg", "mass"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
    Parameter("Ia", "m*r^2/2", "kg m^2", "moment of inertia about the axis"),
    Parameter("Id", "m*r^2/4", "kg m^2", "moment of inertia about a diameter"),
)

_TILT = pi / 9  # 20 degrees
_COIN_TILT = pi / 180
_PRECESSION = 1.5  # [rad/s] of the steady motion


def rolling_disc(**values: float) -> Mechanism:
    """The rolling disc: v_O + omega x (P - O) = 0 at the lowest point P; inputs: horizontal forces on the centre.

    Three degrees of freedom of velocity, five of position. The multipliers are the contact force on the disc: "contact
    height" is F_z, "contact slip_x" and "contact slip_y" are F_x and F_y [N].

    Source: cases of EXUDYN (rollingCoinTest) and PyDy; J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems
    (1972).

    Args:
        values: parameters that differ from the defaults: r [m], m [kg], g [m/s^2], Ia, Id [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="rolling_disc",
        bodies=(Body("disc", "m", (0, 0, 0), ("Ia", "Id", "Id")),),
        joints=(FreeQuaternion("disc", GROUND, "disc", ("x", "y", "z", "e0", "e1", "e2", "e3")),),
        constraints=(RollingDisc("contact", "disc", "r"),),
        actuators=(Actuator("Fx", "x"), Actuator("Fy", "y")),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        home={"z": "r"},
        end_effector="disc",
    )
    return mechanism.with_parameters(**values)


def starts(**values: float) -> dict[str, Start]:
    """`coin`: a spinning coin, tilted by 1 degree; `generic`: a wobbling disc; `steady`: its centre runs in a circle.

    steady: with the tilt a and the precession W, the total spin about n is
    (m g r sin(a) - Id W^2 sin(a) cos(a)) / ((Ia + m r^2) W cos(a)), and the radius of the circle r spin / W.
    """
    coin, disc = rolling_disc(**{"r": 0.01, **values}), rolling_disc(**values)
    tip = f"sin({_TILT!r})"
    level = f"cos({_TILT!r})"
    total = f"(m*g*r*{tip} - Id*{_PRECESSION}^2*{tip}*{level})/((Ia + m*r^2)*{level}*{_PRECESSION})"
    return {
        "coin": _start(coin, _COIN_TILT, 10 * pi, 0, 0.5, "EXUDYN, rollingCoinTest"),
        "generic": _start(disc, _TILT, 0.5, -6, 5.0, "PyDy, rollingdisc"),
        "steady": _start(disc, _TILT, _PRECESSION, f"{total} + {_PRECESSION}*{tip}", 5.0, "Neimark, Fufaev (1972)"),
    }


def _start(disc: Mechanism, tilt: float, turn: float, roll: Scalar, duration: float, source: str) -> Start:
    """Contact at the origin, n = (cos(tilt), 0, -sin(tilt)), omega = turn z + roll n, v = omega x O, 2 e' = e omega."""
    s, c, half_s, half_c = f"sin({tilt!r})", f"cos({tilt!r})", f"sin({tilt / 2!r})", f"cos({tilt / 2!r})"
    wx, wz = f"({roll} - {turn!r}*{s})", f"({turn!r}*{c})"  # omega along the disc's own x and z; none along its y
    return Start(
        disc,
        coordinates={"x": f"r*{s}", "z": f"r*{c}", "e0": half_c, "e2": half_s},
        rates={
            "y": f"-r*{wx}",
            "e1": f"({half_c}*{wx} + {half_s}*{wz})/2",
            "e3": f"({half_c}*{wz} - {half_s}*{wx})/2",
        },
        duration=duration,
        source=source,
    )
