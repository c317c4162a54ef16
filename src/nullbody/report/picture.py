"""The drawing of the 3-PRS robot: an orthographic view with y up, back to front."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nullbody.catalog import three_prs
from nullbody.equations import derive
from nullbody.errors import OutputError
from nullbody.kinematics import assemble
from nullbody.model import Model, State, build
from nullbody.report.figure import BLACK, COLOURS, GREY, drawing, save
from nullbody.report.output import written
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = ["draw_pair", "robot_picture"]

_FORMATS = (".png", ".svg", ".pdf")
_AZIMUTH, _ELEVATION = np.radians(13.0), np.radians(30.0)
_LEGS = np.array([[0, 0, 1], [np.sqrt(3) / 2, 0, -0.5], [-np.sqrt(3) / 2, 0, -0.5]])  # e_i [19]


def robot_picture(path: str | Path) -> Path:
    """Draw the robot at home and at t = 1.5 s of the paper's motion into a file (.png, .svg or .pdf).

    Raises:
        OutputError: the file cannot be written.
    """
    if Path(path).suffix not in _FORMATS:
        raise OutputError(f"{path} cannot be written: its name must end in {', '.join(_FORMATS)}")
    model = build(derive(three_prs(), ("s1", "s2", "s3")))
    sliders = 0.6 + np.array([0.2, -0.3, -0.2]) * np.sin(1.5)
    home = assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6})
    middle = assemble(model, dict(zip(("s1", "s2", "s3"), sliders.tolist(), strict=True)), guess=home)
    with drawing(9.6, 3.5) as canvas:
        draw_pair(canvas, model, [(home, "home: all links vertical"), (middle, "t = 1.5 s of the paper's motion")])
        with written(Path(path)) as temporary:
            save(canvas, temporary)
    return Path(path)


def draw_pair(canvas: Canvas, model: Model, views: Sequence[tuple[State, str]]) -> None:
    """Draw states of the 3-PRS side by side, each with its title."""
    for axes, (state, title) in zip(canvas.subplots(1, len(views)), views, strict=True):
        _Drawing(axes, model, state).draw()
        axes.set_title(title, loc="center", fontweight="normal")


def _seen(points: FloatArray) -> FloatArray:
    """(right, up, towards the viewer) of points (..., 3) in the ground frame."""
    c, s = np.cos(_AZIMUTH), np.sin(_AZIMUTH)
    right, front = np.array([c, 0, s]), np.array([-s, 0, c])
    towards = np.cos(_ELEVATION) * front + np.array([0, np.sin(_ELEVATION), 0])
    up = -np.sin(_ELEVATION) * front + np.array([0, np.cos(_ELEVATION), 0])
    seen: FloatArray = points @ np.array([right, up, towards]).T
    return seen


def _rotation(psi: float, theta: float, phi: float) -> FloatArray:
    """R = Rz(phi) Ry(theta) Rx(psi) [24]"""
    (a, b, c), (d, e, f) = np.cos([psi, theta, phi]), np.sin([psi, theta, phi])
    found: FloatArray = np.array(
        [
            [b * c, -a * f + d * e * c, d * f + a * e * c],
            [b * f, a * c + d * e * f, -d * c + a * e * f],
            [-e, d * b, a * b],
        ]
    )
    return found


class _Drawing:
    """One view of one state."""

    def __init__(self, axes: Axes, model: Model, state: State) -> None:
        self.axes = axes
        values = model.parameters
        a, b, length = values["a"], values["b"], values["l"]
        s = np.array([state[f"s{i}"] for i in (1, 2, 3)])
        self.alpha = np.array([state[f"alpha{i}"] for i in (1, 2, 3)])
        self.A = a * _LEGS
        self.C = (a - s)[:, None] * _LEGS
        up = np.array([0.0, 1.0, 0.0])
        self.B = self.C + length * (np.sin(self.alpha)[:, None] * up - np.cos(self.alpha)[:, None] * _LEGS)
        self.p = np.array([state["x"], state["y"], state["z"]])
        self.R = _rotation(state["psi"], state["theta"], state["phi"])
        self.b, self.l = b, length

    def draw(self) -> None:
        """Ground and rails first, then what stands on them, from back to front."""
        self.axes.set_aspect("equal")
        self.axes.axis("off")
        self._ground()
        order = np.argsort(_seen(self.B)[:, 2])
        behind = [int(i) for i in order if _seen(self.B[i] - self.p)[2] < 0]
        for i in behind:
            self._leg(i)
        self._platform()
        for i in order:
            if int(i) not in behind:
                self._leg(int(i))
        self._joints()
        self.axes.set_xlim(-0.95, 0.95)
        self.axes.set_ylim(-0.5, 0.66)

    def _line(self, *points: FloatArray, **style: object) -> None:
        seen = _seen(np.array(points))
        self.axes.plot(seen[:, 0], seen[:, 1], **style)  # type: ignore[arg-type]

    def _label(self, point: FloatArray, text: str, dx: float = 0, dy: float = 0, **style: object) -> None:
        from matplotlib.patheffects import withStroke

        x, y, _ = _seen(point)
        chosen = {"ha": "center", "va": "center", "fontsize": 10, "zorder": 40, "color": BLACK, **style}
        drawn = self.axes.text(x + dx, y + dy, text, **chosen)  # type: ignore[arg-type]
        drawn.set_path_effects([withStroke(linewidth=2.4, foreground="white", alpha=0.8)])

    def _ring(self, centre: FloatArray, u: FloatArray, v: FloatArray, radius: float) -> FloatArray:
        angle = np.linspace(0, 2 * np.pi, 73)[:, None]
        return _seen(centre + radius * (np.cos(angle) * u + np.sin(angle) * v))

    def _ground(self) -> None:
        x, z = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
        floor = self._ring(np.zeros(3), x, z, 0.86)
        self.axes.fill(floor[:, 0], floor[:, 1], color="#f3f3ef", zorder=0)
        for i, colour in enumerate(COLOURS):
            self._line(np.zeros(3), self.A[i], color="#c9c9c4", lw=5.5, solid_capstyle="round", zorder=1)
            self._line(self.A[i], self.C[i], color=colour, lw=2.2, zorder=2)
            aside = _seen(_LEGS[i])[:2] @ np.array([[0, 1], [-1, 0]]) * 0.06 / np.linalg.norm(_seen(_LEGS[i])[:2])
            aside *= -np.sign(aside[1])
            self._label((self.A[i] + self.C[i]) / 2, f"$s_{i + 1}$", dx=aside[0], dy=aside[1], color=colour)
            self._label(1.08 * self.A[i], f"$A_{i + 1}$", color=colour)
        corner = np.array([-0.8, -0.36])
        for axis, name in ((x, "x"), (np.array([0, 1.0, 0]), "y"), (z, "z")):
            way = 0.13 * _seen(axis)[:2]
            arrow = {"arrowstyle": "-|>", "color": GREY, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
            ends = tuple((corner + way).tolist()), tuple(corner.tolist())
            self.axes.annotate("", *ends, arrowprops=arrow, zorder=3)
            tip = corner + 1.35 * way
            self.axes.text(tip[0], tip[1], f"${name}$", color=GREY, fontsize=9, ha="center", va="center")
        self._label(np.zeros(3), "$O$", dx=-0.03, dy=-0.045, color=GREY, fontsize=9)

    def _leg(self, i: int) -> None:
        colour, e = COLOURS[i], _LEGS[i]
        side = np.cross([0, 1.0, 0], e)
        box = [
            self.C[i] + 0.035 * (sign_e * e + sign_s * side) for sign_e, sign_s in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ]
        seen = _seen(np.array(box))
        self.axes.fill(seen[:, 0], seen[:, 1], facecolor=colour, edgecolor=BLACK, lw=0.8, zorder=10)
        self._line(self.C[i], self.B[i], color=BLACK, lw=6.2, solid_capstyle="round", zorder=11)
        self._line(self.C[i], self.B[i], color=colour, lw=4.4, solid_capstyle="round", zorder=11)
        angle = np.linspace(0, self.alpha[i], 25)[:, None]
        arc = self.C[i] + 0.12 * (-np.cos(angle) * e + np.sin(angle) * np.array([0, 1.0, 0]))
        self._line(*arc, color=colour, lw=1.1, zorder=12)
        middle = self.C[i] + 0.175 * (
            -np.cos(self.alpha[i] / 2) * e + np.sin(self.alpha[i] / 2) * np.array([0, 1.0, 0])
        )
        self._label(middle, rf"$\alpha_{i + 1}$", color=colour)

    def _platform(self) -> None:
        u, v, n = self.R[:, 0], self.R[:, 2], self.R[:, 1]
        for depth, face in ((-0.018, "#9aa3ad"), (0.0, "#dfe5ea")):
            rim = self._ring(self.p + depth * n, u, v, self.b)
            self.axes.fill(rim[:, 0], rim[:, 1], facecolor=face, edgecolor=BLACK, lw=0.9, alpha=0.95, zorder=11)
        for i in range(3):
            self._line(self.p, self.B[i], color=GREY, lw=0.9, ls=(0, (3, 2)), zorder=11)

    def _joints(self) -> None:
        for i, colour in enumerate(COLOURS):
            for point, size in ((self.C[i], 5.5), (self.B[i], 7.0)):
                self._line(point, marker="o", ms=size, mfc="white", mec=BLACK, mew=1.1, zorder=20)
            outwards = float(np.sign(_seen(_LEGS[i])[0]) or 1)
            self._label(self.C[i], f"$C_{i + 1}$", dx=0.075 * outwards, dy=-0.045, color=colour)
            self._label(self.B[i], f"$B_{i + 1}$", dx=0.07 * outwards, dy=0.05, color=colour)
        self._line(self.p, marker="o", ms=3.5, color=BLACK, zorder=20)
        self._label(self.p, "$P$", dx=0.035, dy=0.035)
