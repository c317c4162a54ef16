from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nullbody.catalog import CLOSED_FORMS, closed_form_of, three_prs
from nullbody.errors import AssemblyError, SingularityError
from nullbody.mechanism import MechanismBuilder
from tests.catalog.test_three_prs import closures
from tests.oracles.robot import COORDINATES

DATA = json.loads((Path(__file__).parents[1] / "data" / "prs3_inverse_dynamics.json").read_text(encoding="utf-8"))
PARAMETERS = three_prs().values()
FORM = closed_form_of(three_prs())
assert FORM is not None


def gap(found: dict[str, float]) -> float:
    q = np.array([found[name] for name in COORDINATES])
    return float(np.abs(closures(q, PARAMETERS["a"], PARAMETERS["b"], PARAMETERS["l"])).max())


def turned(one: np.ndarray, other: np.ndarray) -> float:
    """The largest difference, angles modulo a turn."""
    difference = one - other
    difference[3:9] = np.angle(np.exp(1j * difference[3:9]))
    return float(np.abs(difference).max())


def _slides(t: float) -> dict[str, float]:
    return {"s1": 0.6 + 0.2 * np.sin(t), "s2": 0.6 - 0.3 * np.sin(t), "s3": 0.6 - 0.2 * np.sin(t)}


@pytest.mark.parametrize(("t", "count"), [(0.0, 16), (0.5, 12), (1.0, 12), (1.5, 12)])
def test_all_assemblies_are_found_and_closed(t: float, count: int) -> None:
    found = FORM.assemblies(PARAMETERS, _slides(t))
    assert len(found) == count
    assert max(gap(assembly) for assembly in found) < 1e-14
    q = [np.array([assembly[name] for name in COORDINATES]) for assembly in found]
    assert min(turned(q[i], q[j]) for i in range(count) for j in range(i)) > 0.1


@pytest.mark.parametrize("k", range(len(DATA["t"])))
def test_the_reference_pose_is_one_of_the_assemblies(k: int) -> None:
    reference = np.array(DATA["q"][k])
    found = FORM.assemblies(PARAMETERS, dict(zip(COORDINATES[9:], reference[9:], strict=True)))
    q = [np.array([assembly[name] for name in COORDINATES]) for assembly in found]
    assert min(turned(x, reference) for x in q) < 1e-13


@settings(max_examples=25)
@given(st.lists(st.floats(0.3, 0.75), min_size=3, max_size=3))
def test_every_assembly_closes_the_loops(slides: list[float]) -> None:
    found = FORM.assemblies(PARAMETERS, dict(zip(("s1", "s2", "s3"), slides, strict=True)))
    assert len(found) % 2 == 0  # each has its mirror image below the slides
    assert all(gap(assembly) < 1e-13 for assembly in found)


def test_an_assembly_and_its_mirror_image_are_both_found() -> None:
    """Near a double root of the resultant one of the two starts fails."""
    assert len(FORM.assemblies(PARAMETERS, {"s1": 0.642578125, "s2": 0.73828125, "s3": 0.740234375})) == 12


def test_slides_too_far_apart_leave_no_assembly() -> None:
    assert FORM.assemblies(PARAMETERS, {"s1": -1.0, "s2": 0.6, "s3": 0.6}) == []


@settings(max_examples=25)
@given(st.floats(0.3, 0.45), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_inverse_closes_the_loops_with_the_wanted_pose(y: float, psi: float, phi: float) -> None:
    found = FORM.inverse(PARAMETERS, {"y": y, "psi": psi, "phi": phi})
    assert len(found) == 8
    for assembly in found:
        assert gap(assembly) < 1e-14
        assert [assembly[name] for name in ("y", "psi", "phi")] == [y, psi, phi]


def test_inverse_undoes_forward() -> None:
    reference = dict(zip(COORDINATES, DATA["q"][4], strict=True))
    found = FORM.inverse(PARAMETERS, {name: reference[name] for name in ("y", "psi", "phi")})
    nearest = min(found, key=lambda pose: abs(pose["s1"] - reference["s1"]) + abs(pose["s2"] - reference["s2"]))
    assert nearest == pytest.approx(reference, abs=1e-12)


@pytest.mark.parametrize("other", ["psi", "phi"])
def test_inverse_with_theta_and_one_more_angle(other: str) -> None:
    for wanted in (0.2, -0.15):
        found = FORM.inverse(PARAMETERS, {"y": 0.4, "theta": 0.01, other: wanted})
        assert found
        for assembly in found:
            assert gap(assembly) < 1e-13
            assert [assembly["theta"], assembly[other]] == pytest.approx([0.01, wanted])


def test_out_of_reach_names_loop_gap_and_reach() -> None:
    with pytest.raises(AssemblyError, match=r"joint B1 .* 0\.6 m .* link 1 reaches 0\.5 m.*open by 0\.1 m") as caught:
        FORM.inverse(PARAMETERS, {"y": 0.6, "psi": 0.0, "phi": 0.0})
    assert (caught.value.loop, caught.value.gap) == ("leg1", pytest.approx(0.1))


def test_poses_that_do_not_exist_or_are_not_determined() -> None:
    with pytest.raises(SingularityError, match="upside down"):
        FORM.inverse(PARAMETERS, {"y": 0.4, "psi": np.pi, "phi": 0.0})
    with pytest.raises(SingularityError, match="give psi and phi"):
        FORM.inverse(PARAMETERS, {"y": 0.4, "theta": 0.0, "psi": 0.0})


def test_other_known_coordinates_are_left_to_the_general_method() -> None:
    assert FORM.assemblies(PARAMETERS, {"y": 0.4, "psi": 0.0, "phi": 0.0}) is None
    assert FORM.inverse(PARAMETERS, {"x": 0.0, "psi": 0.0, "phi": 0.0}) is None
    assert FORM.inverse(PARAMETERS, {"psi": 0.0, "phi": 0.0}) is None


def test_a_mechanism_of_ones_own_with_a_name_of_the_catalog_has_no_closed_form() -> None:
    for name in CLOSED_FORMS:
        b = MechanismBuilder(name)
        b.rod("arm", 1, 1)
        b.revolute("q", "ground", "arm")
        assert closed_form_of(b.build()) is None
