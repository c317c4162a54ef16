"""The N-four-bar mechanism (IFToMM benchmark A02): a row of parallel bars, the tops of neighbours joined by couplers.

    q = [theta0 .. thetaN | phi1 .. phiN]

The frame has y up. Bar i turns about (i b, 0) by theta_i from the upward vertical, clockwise: its top is
(i b + L sin(theta_i), L cos(theta_i)). Coupler i hangs on the top of bar i - 1, turned by phi_i against it, clockwise.
Lying flat, theta = 90 or 270 degrees, all couplers and bars are in one line: there N + 1 motions are possible at once.
"""

from __future__ import annotations

from numbers import Real

from nullbody.catalog.start import Start
from nullbody.errors import ParameterError
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Revolute, Spherical

__all__ = ["n_four_bar", "starts"]

_PARAMETERS = (
    Parameter("L", 1.0, "m", "length of the bars"),
    Parameter("b", "L", "m", "length of the couplers, and between pivots"),
    Parameter("m", 1.0, "kg", "mass of each bar"),
    Parameter("mc", "m", "kg", "mass of each coupler"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
)


def n_four_bar(n: int = 1, **values: float) -> Mechanism:
    """N four-bars in a row, uniform thin links, input: a torque on bar 0.

    Loop i: top_(i-1) + b (cos(psi_i) x - sin(psi_i) y) - top_i = 0 with psi_i = theta_(i-1) + phi_i. Each loop adds
    theta_i and phi_i and knows no other but its neighbours, so the work grows as N does. Home has all bars upright.

    Source: IFToMM library of computational benchmark problems, A02. Exact, as long as all bars stay parallel:
    theta'^2 = theta'_0^2 + 2 k (1 - cos theta), k = g ((N+1) m/2 + N mc) / (L ((N+1) m/3 + N mc)).

    Args:
        n: number of four-bars N.
        values: parameters that differ from the benchmark's: L, b [m], m, mc [kg], g [m/s^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values, n not a whole number of at least 1.
    """
    count = _whole(n)
    bars, couplers = range(count + 1), range(1, count + 1)
    mechanism = Mechanism(
        name="n_four_bar",
        bodies=(
            *(Body(f"bar{i}", "m", (0, "L/2", 0), ("m*L^2/12", 0, "m*L^2/12")) for i in bars),
            *(Body(f"coupler{i}", "mc", ("b/2", 0, 0), (0, "mc*b^2/12", "mc*b^2/12")) for i in couplers),
        ),
        joints=(
            *(
                Revolute(f"pivot{i}", GROUND, f"bar{i}", (f"theta{i}",), Placement((f"{i}*b", 0, 0)), axis="-z")
                for i in bars
            ),
            *(
                Revolute(f"pin{i}", f"bar{i - 1}", f"coupler{i}", (f"phi{i}",), Placement((0, "L", 0)), axis="-z")
                for i in couplers
            ),
        ),
        loops=tuple(
            Spherical(f"top{i}", f"coupler{i}", f"bar{i}", at=Placement(("b", 0, 0)), on=Placement((0, "L", 0)))
            for i in couplers
        ),
        actuators=(Actuator("torque", "theta0"),),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="bar0",
    )
    return mechanism.with_parameters(**values)


def _whole(n: object) -> int:
    """n, also where it comes as 3.0."""
    if isinstance(n, bool) or not isinstance(n, Real) or n < 1 or n != n // 1:
        raise ParameterError(f"the number n of four-bars must be a whole number of at least 1, not {n!r}")
    return int(float(n))


def starts(n: int = 1, **values: float) -> dict[str, Start]:
    """`upright`: all bars upright, their tops move along x with 1 m/s."""
    mechanism = n_four_bar(n, **values)
    rates = {name: "1/L" if name.startswith("theta") else "-1/L" for name in mechanism.coordinates}
    return {"upright": Start(mechanism, rates=rates, duration=20.0, source="IFToMM A02")}
