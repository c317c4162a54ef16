"""branches: all assemblies, in closed form for the robot, by random starts for others."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody import InputError, UnknownName, assemble, branches, build, derive
from nullbody.control import paper_reference
from tests.mechanisms import four_bar, slider_crank
from tests.robot import HOME, SLIDES, robot, upright


def along(t: float) -> dict[str, float]:
    return dict(zip(SLIDES, paper_reference()(t).position.tolist(), strict=True))


def separation(left: np.ndarray, right: np.ndarray) -> float:
    turn = left - right
    turn[3:9] = np.mod(turn[3:9] + np.pi, 2 * np.pi) - np.pi
    return float(np.abs(turn).max())


@pytest.mark.parametrize(("t", "count"), [(0.0, 16), (0.5, 12), (1.0, 12), (1.5, 12)])
def test_assemblies_along_the_trajectory(t: float, count: int) -> None:
    model = robot()
    found = branches(model, along(t))
    assert len(found) == count
    assert found.complete
    for x in found:
        assert np.abs(model.residual(x.q)).max() <= 1e-14
        assert not x.v.any()
    assert min(separation(x.q, y.q) for x in found for y in found if x is not y) > 1e-3


@pytest.mark.parametrize("t", [0.0, 0.7, 1.4])
def test_nearest_first(t: float) -> None:
    model = robot()
    here = assemble(model, along(t))
    found = branches(model, along(t), guess=here)
    far = [separation(x.q, here.q) for x in found]
    assert far[0] < 1e-12
    assert far == sorted(far)
    assert far[1] > np.radians(29)


def test_assemblies_mirror_at_the_plane_of_the_slides() -> None:
    found = [x["y"] for x in branches(robot(), along(0.9))]
    np.testing.assert_allclose(sorted(found), sorted(-y for y in found), atol=1e-12)


def test_closed_form_finds_all_that_random_starts_find() -> None:
    model, s = robot(), [0.55, 0.63, 0.6]
    known = dict(zip(SLIDES, s, strict=True))
    found, draw = branches(model, known), np.random.default_rng(3)
    for _ in range(25):
        guess = dict(zip(model.coordinates[3:9], draw.uniform(-np.pi, np.pi, 6), strict=True))
        x = assemble(model, known, guess={**guess, "y": draw.uniform(-0.5, 0.5)})
        elevations = [np.exp(1j * y.q[6:9]) for y in found]  # two triples of angles describe each tilt of the platform
        assert min(np.abs(np.exp(1j * x.q[6:9]) - e).max() for e in elevations) < 1e-7


def test_none_out_of_reach() -> None:
    assert len(branches(robot(), {**HOME, "s2": -3.0})) == 0


@pytest.mark.parametrize(("make", "known"), [(four_bar, {"q1": 1.3}), (slider_crank, {"alpha": 1.0})])
def test_other_mechanisms_have_two(make: Any, known: dict[str, float]) -> None:
    model = build(derive(make(), tuple(known)))
    found = branches(model, known)
    assert len(found) == 2
    assert not found.complete
    assert all(np.abs(model.residual(x.q)).max() <= 1e-14 for x in found)
    assert found[0].positions == pytest.approx(assemble(model, known).positions, abs=1e-9)


def test_four_bar_assemblies_mirror_at_the_diagonal() -> None:
    model = build(derive(four_bar(), ("q1",)))
    p, (left, right) = model.parameters, branches(model, {"q1": 1.3})
    pin = p["a"] * np.array([np.cos(1.3), np.sin(1.3)])
    diagonal = pin - [p["d"], 0]
    tips = [p["c"] * np.array([np.cos(x["q3"]), np.sin(x["q3"])]) for x in (left, right)]
    assert tips[0] @ diagonal == pytest.approx(tips[1] @ diagonal, abs=1e-14)
    assert np.linalg.det([tips[0], diagonal]) == pytest.approx(-np.linalg.det([tips[1], diagonal]), abs=1e-14)


def test_wrong_coordinates() -> None:
    with pytest.raises(InputError, match="give 3 coordinates to enumerate branches, not 2"):
        branches(robot(), {"s1": 0.6, "s2": 0.6})
    with pytest.raises(UnknownName):
        branches(robot(), {"s1": 0.6, "s2": 0.6, "s4": 0.6})
    with pytest.raises(InputError, match="finite"):
        branches(robot(), {**HOME, "s1": np.nan})


def test_sequence_of_states() -> None:
    found = branches(robot(), HOME)
    assert found[0] is next(iter(found))
    np.testing.assert_allclose(found[0].q, upright(robot()).q, atol=1e-9)
