"""assemble: closures to rounding, branches that continue the guess, and what is out of reach."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import nullbody
from nullbody import AssemblyError, InputError, Model, State, UnknownName, assemble, build, derive
from nullbody.kinematics import sweep
from nullbody.mechanism import Placement, Rotation
from tests.mechanisms import four_bar, slider_crank, two_bodies
from tests.robot import HOME, SLIDES, robot, tilted, upright

CLOSED = 1e-14
slide = st.floats(0.35, 0.85)


def slides(*s: float) -> dict[str, float]:
    return dict(zip(SLIDES, s, strict=True))


def gap(model: Model, x: State) -> float:
    return float(np.abs(model.residual(x.q)).max(initial=0.0))


@settings(max_examples=60)
@given(s=st.tuples(slide, slide, slide))
def test_loops_close_to_rounding(s: tuple[float, float, float]) -> None:
    model = robot()
    x = assemble(model, slides(*s))
    assert gap(model, x) <= CLOSED
    assert tuple(x.q[9:]) == s
    assert x["y"] > 0


def test_home_is_exact() -> None:
    model = robot()
    x = assemble(model, HOME, v=(0.2, -0.3, -0.2))
    np.testing.assert_allclose(x.q, upright(model).q, atol=1e-16)
    assert x.v.tolist() == [0.2, -0.3, -0.2]


@pytest.mark.parametrize("seed", range(5))
def test_far_guess(seed: int) -> None:
    model, draw = robot(), np.random.default_rng(seed)
    guess = dict(zip(model.coordinates, draw.uniform(-1, 1, 12), strict=True))
    assert gap(model, assemble(model, slides(0.55, 0.6, 0.65), guess=guess)) <= CLOSED


def test_guess_of_many_turns() -> None:
    model = robot()
    guess = {"alpha1": 1e6 + 0.5, "alpha2": -1e6, "psi": 1e6}
    x = assemble(model, slides(0.55, 0.6, 0.65), guess=guess)
    assert gap(model, x) <= 1e-9
    assert abs(x["alpha1"] - 1e6) < 10


def test_guess_chooses_the_branch() -> None:
    model, s = robot(), slides(0.55, 0.6, 0.65)
    above = assemble(model, s)
    mirrored = {name: -value if name in ("y", "psi", "phi", "alpha1", "alpha2", "alpha3") else value
                for name, value in above.positions.items()}  # fmt: skip
    below = assemble(model, s, guess=mirrored)
    assert below["y"] == pytest.approx(-above["y"], abs=1e-14)
    again = assemble(model, slides(0.56, 0.6, 0.65), guess=below)
    assert again["y"] < 0


def test_motion_to_the_target_and_back_returns() -> None:
    model = robot()
    for x in tilted(model, 6, tilt=0.2):
        there = assemble(model, slides(*(x.q[9:] + 0.02)), guess=x)
        back = assemble(model, slides(*x.q[9:]), guess=there)
        np.testing.assert_allclose(back.q, x.q, atol=1e-12)


def test_path_is_continuous() -> None:
    model = robot()
    t = np.linspace(0, 2 * np.pi, 61)
    path = [slides(0.6 + 0.2 * np.sin(k), 0.6 - 0.3 * np.sin(k), 0.6 - 0.2 * np.sin(k)) for k in t]
    states = sweep(model, path)
    steps = np.abs(np.diff([x.q for x in states], axis=0)).max()
    assert steps < 0.1
    np.testing.assert_allclose(states[-1].q, states[0].q, atol=1e-12)


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        ((0.304, 0.595, 0.472), (0.899, 0.572, 0.649)),
        ((0.610, 0.597, 0.369), (0.893, 0.540, 0.911)),
        ((0.493, 0.369, 0.415), (0.528, 1.016, 0.563)),
    ],
)
def test_one_long_way_is_many_short_ones(begin: tuple[float, ...], end: tuple[float, ...]) -> None:
    model, a, b = robot(), np.array(begin), np.array(end)
    states = sweep(model, [slides(*(a + part * (b - a))) for part in np.linspace(0, 1, 60)])
    found = assemble(model, slides(*b), guess=states[0])
    np.testing.assert_allclose(found.q, states[-1].q, atol=1e-12)


def test_where_the_branch_ends_another_one_is_taken_or_an_error_raised() -> None:
    model, begin, end = robot(), slides(0.453, 0.285, 0.555), slides(0.867, 0.358, 0.197)
    start = assemble(model, begin)
    assert gap(model, assemble(model, end, guess=start)) <= CLOSED
    with pytest.raises(
        AssemblyError, match=r"the branch of the guess ends before s1 = 0\.867.*nullbody\.branches"
    ) as caught:
        assemble(model, end, guess=start, same_branch=True)
    assert 0.0 < caught.value.reach < 1.0
    assert caught.value.gap == 0.0


def test_fewer_known_coordinates_move_the_rest_least() -> None:
    model = robot()
    x = assemble(model, {"s1": 0.58})
    assert x["s1"] == 0.58
    assert gap(model, x) <= CLOSED
    assert np.abs(x.q - upright(model).q).max() < 0.1
    np.testing.assert_array_equal(assemble(model, {}).q, upright(model).q)


def test_other_coordinates_than_slides() -> None:
    model, (x,) = robot(), tilted(robot(), 1, seed=4)
    for known in (("y", "psi", "phi"), ("alpha1", "alpha2", "alpha3"), ("s1", "y", "alpha3")):
        found = assemble(model, {name: x[name] for name in known}, guess=x)
        np.testing.assert_allclose(found.q, x.q, atol=1e-11)


def test_forms_of_the_guess() -> None:
    model = robot()
    near = assemble(model, slides(0.58, 0.6, 0.6))
    for guess in (None, near, dict(near.positions), {"alpha1": 1.4}):
        x = assemble(model, slides(0.55, 0.62, 0.6), guess=guess)
        np.testing.assert_allclose(x.q, assemble(model, slides(0.55, 0.62, 0.6)).q, atol=1e-12)


@pytest.mark.parametrize(
    ("known", "error", "message"),
    [
        ({"s1": 0.6, "s2": 0.6, "s3": 0.6, "y": 0.5}, InputError, "has 3 degrees of freedom.*not 4"),
        ({"s_1": 0.6}, UnknownName, "no coordinate 's_1'; did you mean 's1'"),
        ({"s1": "0.6"}, InputError, "real numbers"),
        ({"s1": np.nan}, InputError, "coordinate s1 must be finite"),
        ([0.6, 0.6, 0.6], InputError, r"give coordinates by name, such as \{'x': 0.6\}"),
        (None, InputError, "give coordinates by name"),
    ],
)
def test_wrong_coordinates(known: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        assemble(robot(), known)


def test_wrong_guess() -> None:
    bar = build(derive(four_bar()))
    other = assemble(bar, {"q1": 1.3})
    for guess in (other, [1, 2], {"beta": 1.0}, {"y": "low"}):
        with pytest.raises(InputError):
            assemble(robot(), HOME, guess=guess)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="independent rate"):
        assemble(robot(), HOME, v=(1, 2))


def smallest_gap(model: Model, s: tuple[float, ...], start: np.ndarray) -> float:
    """Smallest norm of all gaps, by another minimiser."""

    def squared(x: np.ndarray) -> float:
        return float((model.residual(np.concatenate([x, s])) ** 2).sum())

    fits = [minimize(squared, start + d, method="BFGS", options={"gtol": 1e-9}) for d in (0, 0.05, -0.05)]
    return float(np.sqrt(min(fit.fun for fit in fits)))


@pytest.mark.parametrize("s", [(0.1, 0.1, -0.9), (0.6, -0.6, 0.6), (1.9, 0.6, 0.6)])
def test_out_of_reach(s: tuple[float, float, float]) -> None:
    model = robot()
    with pytest.raises(AssemblyError) as caught:
        assemble(model, slides(*s))
    error, text = caught.value, str(caught.value)
    assert error.loop in ("leg1", "leg2", "leg3")
    assert 0.0 < error.reach < 1.0
    whole = smallest_gap(model, s, upright(model).q[:9])
    assert whole / np.sqrt(3) * 0.999 <= error.gap <= whole * 1.001
    assert f"loop {error.loop!r} stays open by {error.gap:.3g} m" in text
    assert f"{error.reach:.0%} of the way" in text


def test_reach_is_where_the_loops_last_close() -> None:
    with pytest.raises(AssemblyError, match=r"up to s1 = 0\.1\d*, s2 = 0\.1\d*, s3 = 0\.1") as caught:
        assemble(robot(), slides(-0.4, -0.4, -0.4))  # the links lie flat at s = a - b - l = 0.1, half of the way
    assert caught.value.reach == pytest.approx(0.5, abs=1e-3)
    assert caught.value.gap == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_sizes_from_millimetres_to_kilometres(scale: float) -> None:
    model = robot().replace(a=0.8 * scale, b=0.2 * scale, l=0.5 * scale)
    x, wanted = (
        assemble(model, slides(*(scale * np.array([0.65, 0.62, 0.55])))),
        assemble(robot(), slides(0.65, 0.62, 0.55)),
    )
    assert x["y"] / scale == pytest.approx(wanted["y"], rel=1e-12)
    assert x["psi"] == pytest.approx(wanted["psi"], abs=1e-12)


@pytest.mark.parametrize(("make", "known"), [(four_bar, "q1"), (slider_crank, "alpha")])
def test_full_turns_of_other_mechanisms(make: Any, known: str) -> None:
    model = build(derive(make(), (known,)))
    begin = model.mechanism.home_values(model.parameters)[known]
    states = sweep(model, [{known: begin + angle} for angle in np.linspace(0, 2 * np.pi, 41)])
    assert max(gap(model, x) for x in states) <= CLOSED
    turned = [model.mechanism.units[name] == "rad" for name in model.coordinates]
    change = states[-1].q - states[0].q
    np.testing.assert_allclose(np.where(turned, np.sin(change / 2), change), 0, atol=1e-12)


def test_without_loops_the_rest_stays() -> None:
    model = build(derive(two_bodies()))
    x = assemble(model, {"swing": 0.4, "x": 0.1}, guess={"slide": 0.2})
    assert (x["swing"], x["x"], x["slide"], x["y"]) == (0.4, 0.1, 0.2, 0.0)


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        ((0.957, 0.675, 0.186), (0.790, 0.662, 0.893)),
        ((0.468, 0.161, 0.987), (0.366, 0.394, 0.488)),
        ((0.871, 0.370, 0.205), (0.692, 0.282, 0.198)),
        ((0.855, 0.157, 0.705), (0.685, 0.245, 0.683)),
    ],
)
def test_no_branch_changes_the_sign_of_its_determinant(begin: tuple[float, ...], end: tuple[float, ...]) -> None:
    model = robot()
    start = assemble(model, slides(*begin))
    try:
        found = assemble(model, slides(*end), guess=start, same_branch=True)
    except AssemblyError as error:
        assert 0.0 < error.reach < 1.0
    else:
        signs = [np.sign(model.evaluate("kinematics", x.q, x.v)[3]) for x in (start, found)]
        assert signs[0] == signs[1]


def test_bennett_linkage_from_a_rough_home() -> None:
    # three gaps and two tilts for three angles, two of them independent on the manifold only
    a, b, twist = 0.3, 0.5, 0.6
    other = float(np.arcsin(np.sin(twist) * b / a))

    def end(length: float, angle: float) -> Placement:
        return Placement((length, 0, 0), (Rotation("x", degrees=float(np.degrees(angle))),))

    m = nullbody.MechanismBuilder("bennett")
    for name, length in (("l1", a), ("l2", b), ("l3", a)):
        m.body(name, 1, (length / 2, 0, 0), (0.02, 0.04, 0.05))
    m.revolute("j1", "ground", "l1")
    m.revolute("j2", "l1", "l2", at=end(a, twist))
    m.revolute("j3", "l2", "l3", at=end(b, other))
    m.revolute("j4", "l3", "ground", at=end(a, twist), on=end(-b, -other))
    m.home(j1=0.8, j2=2.816, j3=-0.8)
    model = nullbody.build(nullbody.derive(m.build()))
    state = nullbody.assemble(model, {})
    assert np.abs(model.residual(state.q)).max() < 1e-13
    assert np.abs(model.evaluate("redundant", state.q)[0]).max() < 1e-13
    assert nullbody.derive(model.mechanism).mobility.nv == 1
