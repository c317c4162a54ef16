"""The stiff flyball governor (IFToMM benchmark A05): two heavy arms on a turning shaft, held by stiff spring-dampers.

    q = [phi | s | alpha1 alpha2]

The frame has z up. The shaft turns about z by phi; the slider runs along it, its centre at the height s, and turns
with it. The arms are pinned to the shaft at (+-d, 0, H) of its frame; alpha_i is the angle of an arm below the
horizontal, both arms in the shaft's x-z plane. Spring-dampers join the arms' middles to (+-d, 0, 0) of the slider.
"""

from __future__ import annotations

from nullbody.catalog.start import Start
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Mechanism,
    Parameter,
    Placement,
    Prismatic,
    Revolute,
    Spring,
    Weld,
)

__all__ = ["flyball_governor", "starts"]

_PARAMETERS = (
    Parameter("H", 1.0, "m", "height of the shaft and of the arms' pins"),
    Parameter("d", 0.05, "m", "distance of the pins from the axis", "any"),
    Parameter("l", 1.0, "m", "length of the arms"),
    Parameter("w", 0.01, "m", "side of the square section of shaft and arms", "non-negative"),
    Parameter("b", 0.1, "m", "edge of the slider, a cube", "non-negative"),
    Parameter("rho", 3000.0, "kg/m^3", "density of shaft, arms and slider", "non-negative"),
    Parameter("M", 5.0, "kg", "point mass at the end of each arm"),
    Parameter("m_shaft", "rho*w^2*H", "kg", "mass of the shaft", "non-negative"),
    Parameter("m_arm", "rho*w^2*l", "kg", "mass of each arm", "non-negative"),
    Parameter("m_slider", "rho*b^3", "kg", "mass of the slider"),
    Parameter("k", 8e5, "N/m", "stiffness of each spring", "non-negative"),
    Parameter("c", 4e4, "N s/m", "damping of each spring", "non-negative"),
    Parameter("l0", "l/2", "m", "free length of the springs", "non-negative"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
)


def flyball_governor(**values: float) -> Mechanism:
    """The governor, four degrees of freedom and no loop; input: a torque on the shaft, which turns freely without.

    Spring i: force k (r - l0) + c r' along r = A_i + l/2 (+-cos(alpha_i), 0, -sin(alpha_i)) - (+-d, 0, s) with
    A_i = (+-d, 0, H), in the shaft's frame. Shaft, arms and slider are uniform prisms. The fastest motion decays with
    about 8000 1/s: a stiff method is at home here.

    Home has the arms 30 degrees below the horizontal and the springs free if l0 = l/2.

    Source: IFToMM library of computational benchmark problems, A05.

    Args:
        values: parameters that differ from the benchmark's: H, d, l, w, b, l0 [m], rho [kg/m^3], M, m_shaft, m_arm,
            m_slider [kg], k [N/m], c [N s/m], g [m/s^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    across, cube = "m_arm*(l^2 + w^2)/12", "m_slider*b^2/6"
    upright = "m_shaft*(H^2 + w^2)/12"
    sides = ((1, "", "y"), (2, "-", "-y"))  # number, sign along x, axis of the pin
    mechanism = Mechanism(
        name="flyball_governor",
        bodies=(
            Body("shaft", "m_shaft", (0, 0, "H/2"), (upright, upright, "m_shaft*w^2/6")),
            Body("slider", "m_slider", (0, 0, 0), (cube, cube, cube)),
            *(Body(f"arm{i}", "m_arm", (f"{sign}l/2", 0, 0), ("m_arm*w^2/6", across, across)) for i, sign, _ in sides),
            *(Body(f"ball{i}", "M") for i, _, _ in sides),
        ),
        joints=(
            Revolute("bearing", GROUND, "shaft", ("phi",)),
            Prismatic("rail", "shaft", "slider", ("s",)),
            *(
                Revolute(f"pin{i}", "shaft", f"arm{i}", (f"alpha{i}",), Placement((f"{sign}d", 0, "H")), axis=axis)  # type: ignore[arg-type]
                for i, sign, axis in sides
            ),
            *(Weld(f"end{i}", f"arm{i}", f"ball{i}", at=Placement((f"{sign}l", 0, 0))) for i, sign, _ in sides),
        ),
        loads=tuple(
            Spring(
                f"spring{i}",
                "slider",
                (f"{sign}d", 0, 0),
                f"arm{i}",
                (f"{sign}l/2", 0, 0),
                stiffness="k",
                length="l0",
                damping="c",
            )
            for i, sign, _ in sides
        ),
        actuators=(Actuator("torque", "phi"),),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        home={"s": "H - l/2", "alpha1": "pi/6", "alpha2": "pi/6"},
        end_effector="slider",
    )
    return mechanism.with_parameters(**values)


def starts(**values: float) -> dict[str, Start]:
    """`turning`: home, the whole governor turning rigidly with one revolution a second."""
    governor = flyball_governor(**values)
    return {"turning": Start(governor, rates={"phi": "2*pi"}, duration=10.0, source="IFToMM A05")}
