"""Pictures of mechanisms: the view, what is drawn, and files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nullbody import OutputError, assemble, build, catalog, derive
from nullbody.mechanism import (
    GROUND,
    Body,
    Cylindrical,
    Distance,
    Mechanism,
    Placement,
    PointOnLine,
    Prismatic,
    Revolute,
    Spherical,
    Spring,
)
from nullbody.report import draw, draw_catalog
from nullbody.report.draw import _normal, _view
from nullbody.report.shape import Arrow, Bar, Face, Line, Mark
from nullbody.report.skeleton import Skeleton, skeleton
from nullbody.report.wireframe import shapes

PNG = b"\x89PNG\r\n\x1a\n"


def at_home(mechanism: Mechanism) -> Skeleton:
    values = mechanism.values()
    return skeleton(mechanism, values, mechanism.home_values(values))


def drawn(mechanism: Mechanism, kind: type) -> list:
    given = at_home(mechanism)
    return [part for part in shapes(given, plane=_normal(given) is not None) if isinstance(part, kind)]


PLANE = {
    "a01_pendulum",
    "andrews",
    "chaplygin_sleigh",
    "five_bar",
    "four_bar",
    "n_four_bar",
    "slider_crank",
    "three_rrr",
}


@pytest.mark.parametrize("name", catalog.MODELS)
def test_plane_mechanisms_are_seen_along_their_axes(name: str) -> None:
    given = at_home(catalog.mechanism(name))
    assert (_normal(given) is not None) is (name in PLANE)
    view = _view(given, 0.4, 0.3)
    np.testing.assert_allclose(view @ view.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(view) == pytest.approx(1)
    if name in PLANE:
        np.testing.assert_allclose(view[2], [0, 0, 1], atol=1e-15)  # angles grow counter-clockwise
    gravity = [float(component != 0) for component in given.mechanism.gravity]
    if any(gravity):
        assert np.array(gravity) @ view[0] == pytest.approx(0, abs=1e-15)  # up is up
        assert np.array(gravity) @ view[1] > 0.9


@pytest.mark.parametrize("name", catalog.MODELS)
def test_every_input_has_its_arrow(name: str) -> None:
    mechanism = catalog.mechanism(name)
    assert [arrow.text for arrow in drawn(mechanism, Arrow)] == list(mechanism.inputs)


def test_links_reach_from_joint_to_joint() -> None:
    four_bar = catalog.four_bar()
    lengths = sorted(float(np.linalg.norm(np.diff(bar.points, axis=0))) for bar in drawn(four_bar, Bar))
    assert lengths == pytest.approx([2, 5, 8])
    assert sum(mark.kind == "support" for mark in drawn(four_bar, Mark)) == 2
    assert sum(mark.kind == "pin" for mark in drawn(four_bar, Mark)) == 4


def test_platforms_are_plates_and_sliders_boxes() -> None:
    faces = drawn(catalog.three_prs_vertical(), Face)
    assert sorted(len(face.points) for face in faces) == [3, 3, *[4] * 18]  # floor, plate, three boxes
    assert len(drawn(catalog.stewart_platform(), Face)) == 2
    assert len(drawn(catalog.three_prs_vertical(), Line)) == 3  # the columns


def test_a_slide_that_only_gives_coordinates_is_not_drawn() -> None:
    pendulum = catalog.a01_pendulum()
    assert not drawn(pendulum, Face)
    assert len(drawn(pendulum, Line)) == 1  # the massless bar
    assert [mark.kind for mark in drawn(pendulum, Mark)] == ["support", "mass", "ball", "ball"]


def test_joints_and_loads_of_every_kind() -> None:
    mechanism = Mechanism(
        name="kinds",
        bodies=(Body("slider", 1), Body("arm", 1, (0.3, 0, 0), (0, 0.1, 0.1)), Body("ball", 1), Body("bead", 1)),
        joints=(
            Cylindrical("rod", GROUND, "slider", ("s", "turn"), axis="x"),
            Revolute("hinge", "slider", "arm", ("angle",), axis="y"),
            Spherical("socket", GROUND, "ball", ("e0", "e1", "e2", "e3"), Placement((0, 1, 0))),
            Prismatic("wire", GROUND, "bead", ("b",), Placement((0, 2, 0)), axis="z"),
        ),
        loops=(
            Distance("rod2", "arm", "ball", at=Placement((0.6, 0, 0)), on=Placement((0, 0, 0.2)), length=1.2),
            PointOnLine("groove", GROUND, "bead", at=Placement((0, 2, 0))),
        ),
        loads=(Spring("spring", "slider", (0, 0, 0), "bead", (0, 0, 0), stiffness=1),),
    )
    given = at_home(mechanism)
    parts = shapes(given, plane=False)
    assert {type(part) for part in parts} == {Bar, Face, Line, Mark}
    zigzag = max((part for part in parts if isinstance(part, Line)), key=lambda line: len(line.points))
    np.testing.assert_allclose(zigzag.points[[0, -1]], [[0, 0, 0], [0, 2, 0]], atol=1e-15)


def test_colours_are_those_of_legs() -> None:
    legs = {bar.colour for bar in drawn(catalog.delta(), Bar)} - {"white"}
    assert len(legs) == 3


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_draw_writes_a_file(suffix: str, tmp_path: Path) -> None:
    model = build(derive(catalog.five_bar()))
    path = draw(model, assemble(model, {"theta1": 2.0}), tmp_path / f"picture{suffix}")
    assert path.stat().st_size > 2000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_draw_names_what_it_cannot_write(tmp_path: Path) -> None:
    model = build(derive(catalog.slider_crank()))
    state = assemble(model, {})
    with pytest.raises(OutputError, match=r"must end in \.png, \.svg, \.pdf"):
        draw(model, state, tmp_path / "picture.gif")
    with pytest.raises(OutputError, match="cannot be written"):
        draw(model, state, tmp_path / "nowhere" / "picture.png")


def test_the_album(tmp_path: Path) -> None:
    paths = draw_catalog(tmp_path, "rolling_disc", "chaplygin_sleigh", "n_four_bar", "flyball_governor")
    assert [path.name for path in paths] == [
        "rolling_disc.png",
        "chaplygin_sleigh.png",
        "n_four_bar.png",
        "flyball_governor.png",
    ]
    assert all(path.read_bytes().startswith(PNG) for path in paths)
