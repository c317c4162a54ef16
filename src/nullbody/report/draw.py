"""Pictures of any mechanism in any state: an orthographic view, back to front."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nullbody.errors import OutputError
from nullbody.formats import triple
from nullbody.mechanism import Mechanism, Planar, Prismatic, Revolute, Weld
from nullbody.mechanism.joints.base import axis_vector
from nullbody.model import Model, State
from nullbody.report.figure import BLACK, GREY, drawing, save
from nullbody.report.output import written
from nullbody.report.shape import Arrow, Bar, Face, Line, Mark, Shape, Text
from nullbody.report.skeleton import Skeleton, skeleton
from nullbody.report.wireframe import shapes
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw", "draw_into", "draw_mechanism"]

_FORMATS = (".png", ".svg", ".pdf")
_PARALLEL = 1e-9  # 1 - |cosine| of two axes that are one direction


def draw(model: Model, state: State, path: str | Path, *, azimuth: float = 25.0, elevation: float = 22.0) -> Path:
    """Draw a mechanism in a state into a file (.png, .svg or .pdf).

    Bodies are bars and plates through their joints; bodies of one leg have one colour. Up is against gravity. A plane
    mechanism is seen along its axes, from where its angles grow counter-clockwise; others from aside and above.

    Args:
        model: any model.
        state: where it stands.
        path: the file.
        azimuth: how far the view is turned about the vertical, 0 sees the first horizontal axis to the right [degrees].
        elevation: how far from above [degrees].

    Raises:
        OutputError: the file cannot be written.
    """
    return draw_mechanism(
        model.mechanism, model.parameters, state.positions, path, azimuth=azimuth, elevation=elevation
    )


def draw_mechanism(
    mechanism: Mechanism,
    values: Mapping[str, float],
    q: Mapping[str, float],
    path: str | Path,
    *,
    azimuth: float = 25.0,
    elevation: float = 22.0,
) -> Path:
    """The same from parameter values and coordinates by name, whether the loops are closed or not.

    Raises:
        OutputError: the file cannot be written.
    """
    if Path(path).suffix not in _FORMATS:
        raise OutputError(f"{path} cannot be written: its name must end in {', '.join(_FORMATS)}")
    with drawing(5.6, 4.0) as canvas:
        draw_into(canvas.subplots(), mechanism, values, q, azimuth=azimuth, elevation=elevation)
        with written(Path(path)) as temporary:
            save(canvas, temporary)
    return Path(path)


def draw_into(
    axes: Axes,
    mechanism: Mechanism,
    values: Mapping[str, float],
    q: Mapping[str, float],
    *,
    azimuth: float = 25.0,
    elevation: float = 22.0,
) -> None:
    """The same into axes of a larger figure."""
    given = skeleton(mechanism, values, q)
    view = _view(given, np.radians(azimuth), np.radians(elevation))
    _Drawing(axes, view).draw(shapes(given, plane=_normal(given) is not None), given)


def _normal(given: Skeleton) -> FloatArray | None:
    """The one direction about which everything turns and across which everything slides; None in space."""
    turns: list[FloatArray] = []
    slides: list[FloatArray] = []
    for joint in given.mechanism.joints:
        if not isinstance(joint, Planar | Prismatic | Revolute | Weld):
            return None
        if not isinstance(joint, Weld):
            axis = given.place(joint.parent, joint.at).rotation @ axis_vector(joint.axis)
            (slides if isinstance(joint, Prismatic) else turns).append(axis)
    crossed = [np.cross(slides[0], other) for other in slides[1:]] if slides else []
    known = turns or [axis / np.linalg.norm(axis) for axis in crossed if np.linalg.norm(axis) > _PARALLEL]
    if not known:
        return None
    normal = known[0] if known[0][int(np.argmax(np.abs(known[0])))] > 0 else -known[0]
    alike = all(1 - abs(float(axis @ normal)) < _PARALLEL for axis in turns)
    return normal if alike and all(abs(float(axis @ normal)) < _PARALLEL for axis in slides) else None


def _view(given: Skeleton, azimuth: float, elevation: float) -> FloatArray:
    """Rows: the directions to the right, up and towards the viewer."""
    gravity = triple(given.mechanism.gravity, given.values)
    size, normal = float(np.linalg.norm(gravity)), _normal(given)
    if normal is not None:
        up = -gravity / size if size and abs(float(gravity @ normal)) < _PARALLEL * size else _across(normal)
        return np.array([np.cross(up, normal), up, normal])
    up = -gravity / size if size else np.array([0.0, 0.0, 1.0])
    first = _across(up, prefer=0)
    second = np.cross(up, first)  # points away from the viewer
    right = np.cos(azimuth) * first + np.sin(azimuth) * second
    front = np.cross(right, up)
    towards = np.cos(elevation) * front + np.sin(elevation) * up
    return np.array([right, np.cross(towards, right), towards])


def _across(direction: FloatArray, prefer: int = 1) -> FloatArray:
    """A coordinate axis across a direction, y or x where that is possible."""
    order = (prefer, 2, 0, 1)
    axis = next(k for k in order if abs(direction[k]) < 0.5)
    across: FloatArray = np.eye(3)[axis] - direction[axis] * direction
    found: FloatArray = across / np.linalg.norm(across)
    return found


class _Drawing:
    """One view."""

    def __init__(self, axes: Axes, view: FloatArray) -> None:
        self.axes, self.view = axes, view
        self.reached: list[FloatArray] = []  # everything that must fit
        self.middle = np.zeros(2)
        self.plane = bool(np.abs(view[2]).max() > 1 - _PARALLEL)

    def draw(self, parts: list[Shape], given: Skeleton) -> None:
        """Floor and rails first, then everything from back to front, then marks of joints, inputs and names."""
        self.axes.set_aspect("equal")
        self.axes.axis("off")
        depths = {id(part): self._depth(part) for part in parts}
        self.middle = np.mean(self._seen(given.cloud), axis=0)
        order = sorted(parts, key=lambda part: depths[id(part)])
        for place, part in enumerate(order):
            self._one(part, 10 + 10 * place / len(order), given.size)
        self._frame(given)

    def _depth(self, part: Shape) -> float:
        points = np.atleast_2d(part.point if isinstance(part, Mark | Text) else part.points)
        return float(np.mean(points @ self.view[2])) + (1e-6 if isinstance(part, Mark) else 0.0)

    def _seen(self, points: FloatArray) -> FloatArray:
        seen: FloatArray = np.atleast_2d(points) @ self.view[:2].T
        self.reached.append(seen)
        return seen

    def _one(self, part: Shape, height: float, size: float) -> None:
        if isinstance(part, Face):
            self._face(part, height)
        elif isinstance(part, Bar):
            self._line(part.points, height, color=BLACK, lw=part.width + 1.8)
            self._line(part.points, height + 1e-4, color=part.colour, lw=part.width)
        elif isinstance(part, Line):
            style: dict[str, Any] = {"ls": (0, (4, 3))} if part.dashed else {}
            self._line(part.points, 2 if part.back else height, color=part.colour, lw=part.width, **style)
        elif isinstance(part, Mark):
            self._mark(part, height, size)
        elif isinstance(part, Arrow):
            self._arrow(part, size)
        else:
            self._name(self._seen(part.point)[0], part.text)

    def _face(self, part: Face, height: float) -> None:
        seen = self._seen(part.points)
        edge = {"edgecolor": BLACK if not part.back else "#d8d8d2", "lw": 0.9} if part.edge else {"lw": 0}
        self.axes.fill(
            seen[:, 0], seen[:, 1], facecolor=part.colour, alpha=part.alpha, zorder=1 if part.back else height, **edge
        )

    def _line(self, points: FloatArray, height: float, **style: Any) -> None:
        seen = self._seen(points)
        self.axes.plot(seen[:, 0], seen[:, 1], zorder=height, solid_capstyle="round", solid_joinstyle="round", **style)

    def _mark(self, part: Mark, height: float, size: float) -> None:
        x, y = self._seen(part.point)[0]
        if part.kind == "support":
            side = 0.055 * size
            corners = np.array([[x, y], [x - side, y - 1.5 * side], [x + side, y - 1.5 * side]])
            self.axes.fill(corners[:, 0], corners[:, 1], facecolor="#e4e4de", edgecolor=BLACK, lw=0.9, zorder=3)
            self.axes.plot([x - 1.6 * side, x + 1.6 * side], [y - 1.5 * side] * 2, color=BLACK, lw=1.2, zorder=3)
            return
        diameter, face = {"pin": (6.0, "white"), "ball": (6.0, "white"), "mass": (13.0, part.colour)}[part.kind]
        top = 30 if self.plane and part.kind == "pin" else height
        self.axes.plot([x], [y], marker="o", ms=diameter, mfc=face, mec=BLACK, mew=1.1, zorder=top)

    def _arrow(self, part: Arrow, size: float) -> None:
        seen = self._seen(part.points)
        arc = len(seen) > 2
        if part.aside:
            along = seen[-1] - seen[0]
            across = np.array([along[1], -along[0]]) / (float(np.linalg.norm(along)) or 1.0)
            outwards = 1.0 if float(across @ (seen[0] - self.middle)) >= 0 else -1.0
            seen = seen + 0.07 * size * outwards * across
        self.axes.plot(seen[:-1, 0], seen[:-1, 1], color=BLACK, lw=1.3, zorder=35)
        arrow = {"arrowstyle": "-|>", "color": BLACK, "lw": 1.3, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 9}
        self.axes.annotate("", tuple(seen[-1]), tuple(seen[-5] if arc else seen[0]), arrowprops=arrow, zorder=35)
        ends = seen[[0, len(seen) // 2, -1]] if arc else seen[-1:]
        end = max(ends, key=lambda place: float(np.linalg.norm(place - self.middle)))
        away = end - (np.mean(self._seen(part.points[[0, -1]]), axis=0) if arc else seen[0])
        away *= (0.1 if arc else 0.08) * size / (float(np.linalg.norm(away)) or 1.0)
        self._name(end + away, part.text)

    def _name(self, place: FloatArray, text: str) -> None:
        from matplotlib.patheffects import withStroke

        self.reached.append(place[None, :])
        drawn = self.axes.text(place[0], place[1], text, ha="center", va="center", fontsize=9, color=BLACK, zorder=40)
        drawn.set_path_effects([withStroke(linewidth=2.4, foreground="white", alpha=0.85)])

    def _frame(self, given: Skeleton) -> None:
        """The directions of the axes in the lower left corner."""
        (left, low), (right, high) = (bound(np.vstack(self.reached), axis=0) for bound in (np.min, np.max))
        reach = 0.14 * given.size
        corner = np.array([left - 2.3 * reach, low - 0.3 * reach])
        for axis, name in zip(np.eye(3), "xyz", strict=True):
            way = reach * (self.view[:2] @ axis)
            if np.linalg.norm(way) < 0.2 * reach:
                continue
            arrow = {"arrowstyle": "-|>", "color": GREY, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
            self.axes.annotate("", tuple(corner + way), tuple(corner), arrowprops=arrow, zorder=3)
            tip = corner + 1.35 * way
            self.axes.text(tip[0], tip[1], f"${name}$", color=GREY, fontsize=9, ha="center", va="center")
        margin = 0.12 * given.size
        self.axes.set_xlim(min(left, corner[0]) - margin, right + margin)
        self.axes.set_ylim(min(low, corner[1]) - margin, high + margin)
