"""Published motions: their reference numbers, what of a simulated motion is held against them, and to which digits."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from nullbody.simulate import Trajectory
from nullbody.typing import FloatArray

__all__ = ["PUBLISHED", "Published", "Seen", "reference"]

#: Positions [m, rad, directions] and rates [1/s of these], in the names of the reference.
Seen = tuple[dict[str, FloatArray], dict[str, FloatArray]]


@cache
def reference(name: str, motion: str) -> dict[str, FloatArray]:
    """Times t and columns of one motion of a file in nullbody/report/published."""
    text = files("nullbody.report").joinpath("published", f"{name}.json").read_text(encoding="utf-8")
    return {column: np.array(values) for column, values in json.loads(text)["motions"][motion].items()}


@dataclass(frozen=True)
class Published:
    """One published motion.

    Attributes:
        mechanism: of the catalog, and the name of the file with the reference numbers.
        motion: in that file.
        start: in `catalog.starts`.
        title: for people.
        seen: what is compared.
        digits: largest error of positions and of rates that agrees.
        asked: the accuracy that the publication asks for, in words.
        drawn: up to three columns of the figure; none where another motion of the mechanism is drawn.
        arguments: of the catalog's function.
        options: of `simulate`.
        unit: of the positions.
    """

    mechanism: str
    motion: str
    start: str
    title: str
    seen: Callable[[Trajectory], Seen]
    digits: tuple[float, float]
    asked: str
    drawn: tuple[str, ...] = ()
    arguments: Mapping[str, int] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    unit: str = "m"


def _coordinates(**names: str) -> Callable[[Trajectory], Seen]:
    """Coordinates as they are: the reference's names of positions and rates by coordinate, "position rate"."""
    pairs = {coordinate: both.split() for coordinate, both in names.items()}

    def seen(found: Trajectory) -> Seen:
        positions = {position: found[name] for name, (position, _) in pairs.items()}
        return positions, {rate: found[f"{name}'"] for name, (_, rate) in pairs.items()}

    return seen


def _first_top(found: Trajectory) -> Seen:
    """B0, the top of bar 0: L (sin theta, cos theta)."""
    L, theta, rate = found.model.parameters["L"], found["theta0"], found["theta0'"]
    x, y = L * np.sin(theta), L * np.cos(theta)
    return {"B0_x": x, "B0_y": y}, {"B0_xd": y * rate, "B0_yd": -x * rate}


def _third_node(found: Trajectory) -> Seen:
    """P3, node 2 of the cube: ((1 + sin b) cos a, -cos b, -(1 + sin b) sin a), a and b the first angles, L = 1 m."""
    (a, b), (a_dot, b_dot) = found.q.T[:2], found.q_dot.T[:2]
    reach, reach_dot, c, s = 1 + np.sin(b), np.cos(b) * b_dot, np.cos(a), np.sin(a)
    positions = {"P3_x": reach * c, "P3_y": -np.cos(b), "P3_z": -reach * s, "theta1": a}
    rates = (reach_dot * c - reach * s * a_dot, np.sin(b) * b_dot, -reach_dot * s - reach * c * a_dot)
    return positions, dict(zip(("P3dot_x", "P3dot_y", "P3dot_z"), rates, strict=True))


def _both_pins(found: Trajectory) -> Seen:
    """Crank angle, crank pin 1 and rocker pin 2 of the four-bar."""
    p, (crank, _, rocker), (w, _, r) = found.model.parameters, found.q.T, found.q_dot.T
    x1, y1 = p["crank"] * np.cos(crank), p["crank"] * np.sin(crank)
    x2, y2 = p["rocker"] * np.cos(rocker), p["rocker"] * np.sin(rocker)
    positions = {"theta1": crank, "x1": x1, "y1": y1, "x2": p["base"] + x2, "y2": y2}
    return positions, {"theta1_d": w, "x1_d": -y1 * w, "y1_d": x1 * w, "x2_d": -y2 * r, "y2_d": x2 * r}


def _sleigh(found: Trajectory) -> Seen:
    """Place, heading, speed along the blade, turning rate."""
    phi, (x_dot, y_dot, omega) = found["phi"], found.q_dot.T
    positions = {name: found[name] for name in ("x", "y", "phi")}
    return positions, {"v": x_dot * np.cos(phi) + y_dot * np.sin(phi), "omega": omega}


def _disc(found: Trajectory) -> Seen:
    """Centre, axis and angular velocity of the disc, from Euler parameters e: omega = 2 e' e*."""
    x, y, z, e0, e1, e2, e3 = found.q.T
    d0, d1, d2, d3 = found.q_dot.T[3:]
    axis = (1 - 2 * (e2**2 + e3**2), 2 * (e1 * e2 + e0 * e3), 2 * (e1 * e3 - e0 * e2))
    spin = (
        2 * (-e1 * d0 + e0 * d1 - e3 * d2 + e2 * d3),
        2 * (-e2 * d0 + e3 * d1 + e0 * d2 - e1 * d3),
        2 * (-e3 * d0 - e2 * d1 + e1 * d2 + e0 * d3),
    )
    positions = dict(zip(("x", "y", "z", "n_x", "n_y", "n_z"), (x, y, z, *axis), strict=True))
    return positions, dict(zip(("wx", "wy", "wz"), spin, strict=True))


_pendulum = _coordinates(x="x xd", y="y yd")
_ANGLES = ("beta", "theta", "gamma", "phi", "delta", "omega", "epsilon")
_squeezer = _coordinates(**{name: f"{name} {name}_d" for name in _ANGLES})
_governor = _coordinates(s="s sdot", alpha1="alpha alphadot", phi="phi_shaft omega_shaft")
_ENERGY = "|E - E₀| < 0.1 J"


def _row(n: int, drawn: tuple[str, ...] = ()) -> Published:
    """A02 with N loops."""
    title = f"A02, {n} four-bar{'s' * (n > 1)}"
    digits, loose = (2e-5, 2e-4), {"rtol": 1e-9}
    return Published("n_four_bar", str(n), "upright", title, _first_top, digits, _ENERGY, drawn, {"n": n}, loose)


def _rolling(motion: str, title: str, drawn: tuple[str, ...] = ()) -> Published:
    """A rolling disc."""
    return Published("rolling_disc", motion, motion, title, _disc, (5e-9, 5e-9), "none", drawn)


#: In the order of the page.
PUBLISHED: tuple[Published, ...] = (
    Published(
        "a01_pendulum", "horizontal", "horizontal", "A01, pendulum", _pendulum, (1e-9, 3e-9), "1e-6 m", ("x", "y")
    ),
    _row(1),
    _row(3, ("B0_x", "B0_y")),
    _row(40),
    Published(
        "andrews",
        "test_set",
        "test_set",
        "A03, Andrews' mechanism",
        _squeezer,
        (5e-10, 2e-7),
        "1e-6, relative",
        ("beta", "theta", "epsilon"),
        unit="rad",
    ),
    Published(
        "bricard",
        "cube",
        "cube",
        "A04, Bricard's mechanism",
        _third_node,
        (1e-10, 1e-10),
        "1e-3 J, 1e-6 m",
        ("P3_x", "P3_y", "P3_z"),
        unit="m, rad",
    ),
    Published(
        "flyball_governor",
        "turning",
        "turning",
        "A05, flyball governor (stiff)",
        _governor,
        (1e-7, 1e-7),
        "1e-3 m",
        ("s", "alpha"),
        options={"method": "stiff", "rtol": 1e-9},
        unit="m, rad",
    ),
    Published("four_bar", "ferrol", "ferrol", "Four-bar, A Coruña", _both_pins, (3e-8, 3e-8), "1e-6 m", unit="m, rad"),
    Published(
        "four_bar",
        "almeria",
        "almeria",
        "Four-bar, Almería",
        _both_pins,
        (3e-10, 3e-10),
        "1e-6 m",
        ("x2", "y2"),
        unit="m, rad",
    ),
    Published(
        "chaplygin_sleigh",
        "backwards",
        "backwards",
        "Chaplygin sleigh",
        _sleigh,
        (1e-9, 1e-10),
        "1e-8 m",
        ("x", "y", "phi"),
        unit="m, rad",
    ),
    _rolling("coin", "Rolling coin"),
    _rolling("generic", "Wobbling disc", ("x", "y", "n_z")),
    _rolling("steady", "Disc in steady rolling"),
)
