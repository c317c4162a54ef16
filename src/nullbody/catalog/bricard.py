"""Bricard's mechanism (IFToMM benchmark A04): six bars of a cube's edges, one of them the ground, joined by revolutes.

    q = [theta1 theta2 theta3 theta4 theta5]

At home rod k runs along an edge of a cube from node k - 1 to node k, and all bodies' axes are those of the ground:
(0,0,0), (L,0,0), (L,-L,0), (L,-L,L), (0,-L,L), (0,0,L). theta_k turns rod k against rod k - 1 at node k - 1, about y,
z, x, y, z; at node 5 the last revolute, about x, closes the loop on the ground. Gravity is along -y.

The loop's five equations hold for one more degree of freedom than counting gives: on the manifold, and only there, one
of them follows from the others, and which one may be left out changes on the way.
"""

from __future__ import annotations

from nullbody.catalog.start import Start
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Revolute

__all__ = ["bricard", "starts"]

_PARAMETERS = (
    Parameter("L", 1.0, "m", "length of each rod"),
    Parameter("w", 0.1, "m", "side of the rods' square section", "non-negative"),
    Parameter("m", 1.0, "kg", "mass of each rod"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
)

_DIRECTIONS = ("x", "-y", "z", "-x", "y")  # of rods 1..5 at home
_AXES = ("y", "z", "x", "y", "z")  # of the joints at nodes 0..4


def bricard(**values: float) -> Mechanism:
    """Bricard's mechanism, uniform rods of square section, input: a torque on rod 1.

    Loop: node 5 of rod 5 minus (0, 0, L) = 0, and rod 5's x axis at right angles to the ground's y and z.

    Source: IFToMM library of computational benchmark problems, A04 (w = 0.1 m); other codes use thin rods, w = 0.

    Args:
        values: parameters that differ from the benchmark's: L, w [m], m [kg], g [m/s^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    rods = range(1, 6)
    mechanism = Mechanism(
        name="bricard",
        bodies=tuple(_rod(f"rod{k}", _DIRECTIONS[k - 1]) for k in rods),
        joints=tuple(
            Revolute(
                f"node{k - 1}",
                GROUND if k == 1 else f"rod{k - 1}",
                f"rod{k}",
                (f"theta{k}",),
                Placement() if k == 1 else _along(_DIRECTIONS[k - 2], "L"),
                axis=_AXES[k - 1],  # type: ignore[arg-type]
            )
            for k in rods
        ),
        loops=(Revolute("node5", GROUND, "rod5", at=Placement((0, 0, "L")), on=_along("y", "L"), axis="x"),),
        actuators=(Actuator("torque", "theta1"),),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="rod2",
    )
    return mechanism.with_parameters(**values)


def _along(direction: str, length: str) -> Placement:
    """A point on an axis of the body's frame."""
    signed = f"-{length}" if direction.startswith("-") else length
    x, y, z = (signed if direction[-1] == axis else 0 for axis in "xyz")
    return Placement((x, y, z))


def _rod(name: str, direction: str) -> Body:
    """A uniform prism along an axis of its frame: m w^2/6 about it, m (L^2 + w^2)/12 across."""
    x, y, z = ("m*w^2/6" if direction[-1] == axis else "m*(L^2 + w^2)/12" for axis in "xyz")
    return Body(name, "m", _along(direction, "L/2").position, (x, y, z))


def starts(**values: float) -> dict[str, Start]:
    """`cube`: at rest on the edges of the cube."""
    return {"cube": Start(bricard(**values), duration=10.0, source="IFToMM A04")}
