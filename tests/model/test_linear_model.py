"""Derivatives in use: on the manifold, of a step, with parameters that follow, for many states; and what is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import nullbody
from nullbody import InputError, Model, SingularityError, State, UnknownName, assemble, build, derive
from nullbody.kernels import Program
from nullbody.mechanism import Actuator
from tests.mechanisms import four_bar, tip_mass
from tests.model.derivative_cases import COMPLEX, QUICK, Case, agree, case, complex_steps

# -- parameters that follow ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("given", [{}, {"Ixx": 0.013, "Iyy": 0.02, "Izz": 0.013}])
@pytest.mark.parametrize("names", [("b",), ("M", "b"), ("l", "m")])
def test_following_parameters_equal_differences_of_replace(given: dict[str, float], names: tuple[str, ...]) -> None:
    model = case("three_prs").model.replace(**given)
    found = model.derivatives.following(*names)
    for k, name in enumerate(names):
        h, held = 1e-6, {other: model.parameters[other] for other in names if other != name}
        up, down = (
            np.array(model.replace(**held, **{name: model.parameters[name] + way * h}).values) for way in (1, -1)
        )
        agree(found[:, k], (up - down) / (2 * h), 1e-8)


def test_a_long_chain_of_parameters_is_followed() -> None:
    b = nullbody.MechanismBuilder("chain")
    b.parameter("p0", 0.5, "kg")
    for k in range(1, 400):
        b.parameter(f"p{k}", f"p{k - 1}*1.001", "kg")
    b.point_mass("bead", "p399")
    b.prismatic("rail", "ground", "bead", axis="x")
    model = build(derive(b.build()))
    assert model.derivatives.following("p0")[-1, 0] == pytest.approx(1.001**399, rel=1e-10)


def test_unknown_names_are_refused() -> None:
    derivatives = case("four_bar").model.derivatives
    with pytest.raises(UnknownName, match="there is no parameter 'aa'"):
        derivatives.following("aa")
    with pytest.raises(UnknownName, match="there is no kind of derivatives 'forward'"):
        derivatives.kernel("forward")  # type: ignore[arg-type]


# -- on the manifold ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["four_bar", "four_bar by its rocker", "three_prs", "n_four_bar"])
def test_minimal_equals_differences_of_assembled_neighbours(name: str) -> None:
    at = case(name)
    model, nv = at.model, len(at.v)
    found = at.model.derivatives.minimal(at.state, at.u)
    assert found.states == (*model.independent, *(f"{name}'" for name in model.independent))
    np.testing.assert_array_equal(found.A[:nv], np.hstack([np.zeros((nv, nv)), np.eye(nv)]))
    np.testing.assert_allclose(found.tangent, model.null_space(at.state).N, atol=1e-13)
    h = 1e-5
    for k, coordinate in enumerate(model.independent):
        slopes = []
        for way in (1, -1):
            known = {other: at.state[other] + way * h * (other == coordinate) for other in model.independent}
            beside = assemble(model, known, at.v, guess=at.state)
            slopes.append((beside.q, model.forward_dynamics(beside, at.u)[model.independent_columns]))
        agree(found.tangent[:, k], (slopes[0][0] - slopes[1][0]) / (2 * h), 1e-7)
        agree(found.A[nv:, k], (slopes[0][1] - slopes[1][1]) / (2 * h), 1e-6)
    rate = model.derivatives.rate(at.state, at.u)
    np.testing.assert_array_equal(found.A[nv:, nv:], rate.A[-nv:, -nv:])
    np.testing.assert_array_equal(found.B, np.vstack([np.zeros((nv, len(at.u))), rate.B[-nv:]]))


def test_minimal_of_what_rolls_has_more_coordinates_than_rates() -> None:
    at = case("rolling_disc")
    model = at.model
    found = model.derivatives.minimal(at.state, at.u)
    count = model.freedom
    free = [model.coordinates.index(name) for name in found.states[:count]]
    assert (count, len(model.independent), found.A.shape) == (5, 3, (8, 8))
    assert set(model.independent) < set(found.states)
    np.testing.assert_allclose(model.jacobian(at.state.q) @ found.tangent, 0, atol=1e-13)
    np.testing.assert_allclose(found.tangent[free], np.eye(count), atol=1e-13)
    h = 1e-5
    for k, place in enumerate(free):
        sides = []
        for way in (1, -1):
            moved = at.state.q + way * h * found.tangent[:, k]
            known = {model.coordinates[j]: moved[j] for j in free}
            beside = assemble(model, known, at.v, guess=dict(zip(model.coordinates, moved, strict=True)))
            accelerated = model.forward_dynamics(beside, at.u)[model.independent_columns]
            sides.append(np.concatenate([model.velocity(beside)[free], accelerated]))
        agree(found.A[:, k], (sides[0] - sides[1]) / (2 * h), 1e-6)
        assert place == model.coordinates.index(found.states[k])


def test_the_pendulums_frequency_is_that_of_the_textbook() -> None:
    at = case("cart")
    model = at.model.replace(amplitude=1e-12, damping=1e-12)
    hanging = assemble(model, {"pin": -np.pi / 2})
    A = model.derivatives.minimal(hanging).A
    assert abs(np.linalg.eigvals(A)).max() ** 2 == pytest.approx(1.5 * 9.81 / 0.3, rel=1e-9)


# -- a step -----------------------------------------------------------------------------------------------------------


def runge_kutta(program: Program, at: Case, groups: list[np.ndarray], h: float) -> np.ndarray:
    """The step by the tape's interpreter, in complex numbers where the groups are."""
    q, v, *rest = groups
    nq, time = len(q), at.model.rheonomic
    x = np.concatenate([q, v])
    k = np.zeros(len(x))
    total = np.zeros(len(x))
    for a, weight in ((0, 1), (0.5, 2), (0.5, 2), (1, 1)):
        y = x + a * h * k
        others = [rest[0], rest[1] + a * h, rest[2]] if time else rest
        values = np.array(program.tape.run([*y, *np.concatenate(others)], COMPLEX))
        k = np.concatenate([values[nq : 2 * nq], values[at.model.independent_columns]])
        total = total + weight * k
    return x + h / 6 * total


@pytest.mark.parametrize("name", QUICK)
def test_step_equals_complex_steps(name: str) -> None:
    at, h = case(name), 0.02
    program = at.program("forward_dynamics")
    assert [key for key, _ in program.outputs[:2]] == ["q_ddot", "q_dot"]
    groups = [group.astype(complex) for group in at.groups("forward_dynamics")]
    found = at.model.derivatives.step(at.state, at.u, h)
    np.testing.assert_allclose(np.concatenate([found.q, found.v]), runge_kutta(program, at, groups, h).real, atol=1e-11)
    columns = []
    for place in (0, 1, 2, -1):
        for k in range(len(groups[place])):
            shifted = [group.copy() for group in groups]
            shifted[place][k] += 1e-30j
            columns.append(runge_kutta(program, at, shifted, h).imag / 1e-30)
    agree(np.hstack([found.A, found.B, found.p]), np.array(columns).T)


def test_a_short_step_is_the_exponential_of_the_linear_model() -> None:
    at = case("three_prs")
    still = at.model.state(at.state.q.copy())
    u = at.model.inverse_dynamics(still, np.zeros(3))
    rate, h = at.model.derivatives.rate(still, u), 2e-4
    assert np.abs(rate.rate).max() < 1e-12
    agree(at.model.derivatives.step(still, u, h).A, expm(h * rate.A), 1e-11)
    backwards = at.model.derivatives.step(still, u, -h).A
    agree(backwards @ at.model.derivatives.step(still, u, h).A, np.eye(15), 1e-11)


@pytest.mark.parametrize("h", [float("nan"), float("inf"), True, "0.1", None, [0.1]])
def test_a_step_that_is_no_number_is_refused(h: Any) -> None:
    at = case("four_bar")
    with pytest.raises(InputError, match="step"):
        at.model.derivatives.step(at.state, at.u, h)


# -- errors, batches, parameters of a model ------------------------------------------------------------------------


def test_singular_states_raise_as_the_model_does() -> None:
    model = build(derive(four_bar(), ("q1",)))
    a, b, c, d = (model.parameters[name] for name in "abcd")
    elbow = np.arccos(((a + b) ** 2 + d**2 - c**2) / (2 * (a + b) * d))  # crank and coupler in one line
    pin = np.array([(a + b) * np.cos(elbow) - d, (a + b) * np.sin(elbow)])
    state = derive_rocker(model, elbow, float(np.arctan2(pin[1], pin[0])))
    rocker = build(derive(four_bar(), ("q3",)))
    singular = rocker.trusted_state(state.q.copy(), np.array([0.3]))
    for call in (
        lambda: rocker.derivatives.rate(singular),
        lambda: rocker.derivatives.forward_dynamics(singular),
        lambda: rocker.derivatives.inverse_dynamics(singular, [0.0]),
        lambda: rocker.derivatives.minimal(singular),
        lambda: rocker.derivatives.step(singular, None, 1e-3),
    ):
        with pytest.raises(SingularityError, match="the independent coordinates q3 are singular here"):
            call()


def derive_rocker(model: Model, crank: float, rocker: float) -> State:
    return model.trusted_state(np.array([crank, 0.0, rocker]), np.zeros(1))


def test_a_singular_mass_and_useless_inputs_are_named() -> None:
    stretched = build(derive(tip_mass()))
    state = stretched.state({"q1": 0.3, "q2": 0.0})
    for call in (stretched.derivatives.rate, stretched.derivatives.forward_dynamics):
        with pytest.raises(SingularityError, match="the reduced mass matrix is singular here"):
            call(state)
    driven = replace(four_bar(), actuators=(Actuator("t3", "q3"),))
    model = build(derive(driven, ("q1",)))
    a, b, c, d = (model.parameters[name] for name in "abcd")
    crank = np.arccos(((a + b) ** 2 + d**2 - c**2) / (2 * (a + b) * d))
    pin = (a + b) * np.array([np.cos(crank), np.sin(crank)]) - [d, 0]
    dead = model.state({"q1": crank, "q2": 0.0, "q3": float(np.arctan2(pin[1], pin[0]))})
    with pytest.raises(SingularityError, match="the inputs t3 cannot drive all degrees of freedom here"):
        model.derivatives.inverse_dynamics(dead, [0.0])


def test_states_and_inputs_are_checked() -> None:
    at = case("three_prs")
    derivatives = at.model.derivatives
    with pytest.raises(InputError, match="another mechanism"):
        derivatives.rate(case("four_bar").state)
    with pytest.raises(InputError, match="3 input values are needed"):
        derivatives.step(at.state, [1.0], 0.01)
    with pytest.raises(InputError, match="independent acceleration"):
        derivatives.inverse_dynamics(at.state, [1.0])


def test_another_chart_of_the_state_is_taken() -> None:
    at, other = case("four_bar"), case("four_bar by its rocker")
    moved = other.model.own(at.state)
    np.testing.assert_allclose(
        other.model.derivatives.rate(at.state, at.u).A, other.model.derivatives.rate(moved, at.u).A
    )


@pytest.mark.parametrize("kind", ["rate", "forward_dynamics", "inverse_dynamics"])
@pytest.mark.parametrize("name", ["three_prs", "cart"])
def test_batches_equal_single_calls(name: str, kind: Any) -> None:
    at = case(name)
    kernel = at.model.derivatives.kernel(kind)
    q, v, third, *rest = at.groups(kind)
    many = 1e-3 * at.draw.normal(size=(11, len(q))) + q
    rates = at.draw.normal(size=(11, len(v)))
    found = kernel.batch(many, rates, third, *rest)
    for k in range(11):
        for single, rows in zip(kernel(many[k], rates[k], third, *rest), found, strict=True):
            np.testing.assert_allclose(rows[k], single, rtol=1e-9, atol=1e-9 * max(1, np.abs(single).max(initial=0)))


def test_replaced_parameters_are_used_and_nothing_is_compiled_again() -> None:
    at = case("four_bar")
    heavy = at.model.replace(m=1.4)
    assert heavy.derivatives.kernel("rate") is at.model.derivatives.kernel("rate")
    state = heavy.state(at.state.q.copy(), at.v)
    groups = [*at.groups("forward_dynamics")[:-1], np.array(heavy.values)]
    steps = complex_steps(at.program("forward_dynamics"), groups, ("q_ddot",))
    agree(heavy.derivatives.forward_dynamics(state, at.u).q, steps["q"])
