"""The model in JAX: jit, vmap, grad and jacobians against the model and differences."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from nullbody import InputError
from nullbody.model.jax_functions import JaxFunctions
from tests.model.derivative_cases import Case, agree, case

os.environ.setdefault("JAX_PLATFORMS", "cpu")  # before JAX looks for accelerators
jax = pytest.importorskip("jax", reason="JAX is not installed: pip install jax")


@pytest.fixture(autouse=True)
def double_precision() -> Iterator[None]:
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


def functions(name: str) -> tuple[Case, JaxFunctions, tuple[Any, ...]]:
    at = case(name)
    return at, at.model.as_jax(), (at.state.q, at.v, at.u, at.state.t, np.array(at.model.values))


NAMES = ["three_prs", "rolling_disc", "cart", "drive"]  # u, N^T Q, the time, no degree of freedom


@pytest.mark.parametrize("name", NAMES)
def test_values_equal_the_models(name: str) -> None:
    at, made, arguments = functions(name)
    q, v, u, t, _ = arguments
    rate = at.model.derivatives.rate(at.state, at.u).rate
    np.testing.assert_allclose(made.rate(*arguments), rate, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(made.forward_dynamics(q, v, u, t), at.model.plain.forward_dynamics(at.state, at.u))
    forces = at.model.derivatives.inverse_dynamics(at.state, at.v_dot).force
    found = jax.jit(made.inverse_dynamics)(q, v, at.v_dot, t)
    np.testing.assert_allclose(found, forces, rtol=1e-12, atol=1e-12)
    if len(at.u):
        unforced = at.model.plain.forward_dynamics(at.state)
        np.testing.assert_array_equal(made.forward_dynamics(q, v, t=t), unforced)


@pytest.mark.parametrize(("name", "mode"), [*((name, jax.jacrev) for name in NAMES), ("cart", jax.jacfwd)])
def test_jacobians_equal_the_exact_ones(name: str, mode: Any) -> None:
    at, made, (q, v, u, t, p) = functions(name)
    forward = at.model.derivatives.forward_dynamics(at.state, at.u)
    inverse = at.model.derivatives.inverse_dynamics(at.state, at.v_dot)
    rate = at.model.derivatives.rate(at.state, at.u)
    A = np.split(rate.A, [len(q)], axis=1)
    for function, third, expected in (
        (made.forward_dynamics, u, forward[1:]),
        (made.inverse_dynamics, at.v_dot, inverse[1:]),
        (made.rate, u, (*A, rate.B, rate.t, rate.p)),
    ):
        found = jax.jit(mode(function, (0, 1, 2, 3, 4)))(q, v, third, t, p)
        for part, slope in zip(expected, found, strict=True):
            agree(np.asarray(slope), part, 1e-13)


def test_gradient_equals_differences() -> None:
    _, made, (q, v, u, _, p) = functions("three_prs")

    def cost(q: Any, p: Any) -> Any:
        return jax.numpy.sum(jax.numpy.sin(made.forward_dynamics(q, v, u, p=p)))

    found, fast = jax.jit(jax.grad(cost, (0, 1)))(q, p), jax.jit(cost)
    for place, slope in enumerate(found):
        for k in range(len(slope)):
            h = 1e-6
            sides = []
            for way in (1, -1):
                moved = [q.copy(), p.copy()]
                moved[place][k] += way * h
                sides.append(float(fast(*moved)))
            assert (sides[0] - sides[1]) / (2 * h) == pytest.approx(float(slope[k]), rel=1e-5, abs=1e-5)


def test_vmap_takes_any_axes_and_shared_arguments() -> None:
    at, made, (q, v, u, _, _) = functions("three_prs")
    draw = np.random.default_rng(0)
    many, rates = q + 1e-3 * draw.normal(size=(5, 12)), draw.normal(size=(4, 3))
    grid = jax.jit(jax.vmap(jax.vmap(made.rate, (None, 0, None)), (0, None, None)))(many, rates, u)
    slopes = jax.jit(jax.vmap(jax.vmap(jax.jacrev(made.rate), (None, 0, None)), (0, None, None)))(many, rates, u)
    assert (grid.shape, slopes.shape) == ((5, 4, 15), (5, 4, 15, 12))
    for i in range(5):
        for j in range(4):
            state = at.model.trusted_state(many[i].copy(), rates[j].copy())
            expected = at.model.derivatives.rate(state, u)
            np.testing.assert_allclose(grid[i, j], expected.rate, rtol=1e-10, atol=1e-10)
            agree(np.asarray(slopes[i, j]), expected.A[:, :12])
    single = jax.vmap(made.rate, (0, None, None))(many[:1], v, u)
    np.testing.assert_array_equal(single[0], made.rate(many[0], v, u))
    assert jax.vmap(made.rate, (0, None, None))(many[:0], v, u).shape == (0, 15)


def test_a_rollout_is_differentiated_as_steps_are() -> None:
    at, made, (q, v, u, _, _) = functions("three_prs")
    jnp, h = jax.numpy, 0.01

    def step(x: Any, u: Any) -> Any:
        def f(x: Any) -> Any:
            return made.rate(x[:12], x[12:], u)

        k1 = f(x)
        k2 = f(x + h / 2 * k1)
        k3 = f(x + h / 2 * k2)
        k4 = f(x + h * k3)
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), None

    rollout = jax.jit(jax.jacrev(lambda x, inputs: jax.lax.scan(step, x, inputs)[0], (0, 1)))
    by_start, by_inputs = rollout(jnp.concatenate([q, v]), jnp.stack([u, 2 * u]))
    first = at.model.derivatives.step(at.state, u, h)
    second = at.model.derivatives.step(at.model.trusted_state(first.q, first.v), 2 * u, h)
    agree(np.asarray(by_start), second.A @ first.A)
    agree(np.asarray(by_inputs[:, 0]), second.A @ first.B)
    agree(np.asarray(by_inputs[:, 1]), second.B)


def test_singular_states_are_nan() -> None:
    made = case("four_bar by its rocker").model.as_jax()
    model = case("four_bar by its rocker").model
    a, b, c, d = (model.parameters[name] for name in "abcd")
    crank = np.arccos(((a + b) ** 2 + d**2 - c**2) / (2 * (a + b) * d))
    pin = (a + b) * np.array([np.cos(crank), np.sin(crank)]) - [d, 0]
    dead = np.array([crank, 0.0, np.arctan2(pin[1], pin[0])])
    good = case("four_bar by its rocker").state.q
    found = jax.vmap(made.forward_dynamics, (0, None))(np.array([good, dead]), np.ones(1))
    slopes = jax.vmap(jax.jacrev(made.rate), (0, None))(np.array([good, dead]), np.ones(1))
    for array in (found, slopes):
        assert np.isfinite(array[0]).all()
        assert np.isnan(array[1]).any()
    assert np.isnan(found[1]).all()


def test_wrong_shapes_are_named() -> None:
    _, made, (q, v, *_) = functions("three_prs")
    with pytest.raises(InputError, match=r"rate: v must have the shape \(3,\), not \(2,\)"):
        made.rate(q, v[:2])
    with pytest.raises(InputError, match=r"inverse_dynamics: v_dot must have the shape"):
        made.inverse_dynamics(q, v)


def test_second_derivatives_are_refused_by_name() -> None:
    _, made, (q, v, *_) = functions("four_bar")
    with pytest.raises(InputError, match="no second derivatives"):
        jax.hessian(lambda q: made.forward_dynamics(q, v)[0])(q)


def test_single_precision_is_refused() -> None:
    _, made, (q, v, *_) = functions("four_bar")
    jax.config.update("jax_enable_x64", False)
    for call in (case("four_bar").model.as_jax, lambda: made.rate(q, v)):
        with pytest.raises(InputError, match=r"jax.config.update\('jax_enable_x64', True\)"):
            call()


def test_without_jax_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jax", None)
    with pytest.raises(InputError, match=r"JAX is not installed; run: python -m pip install 'nullbody\[jax\]'"):
        case("four_bar").model.as_jax()


def test_jax_is_imported_only_when_asked_for() -> None:
    program = "import sys, nullbody, nullbody.model; print('jax' in sys.modules, 'casadi' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_what_is_no_real_number_is_named() -> None:
    _, made, (q, v, *_) = functions("three_prs")
    for arguments, says in (
        ((q * 1j, v), "rate: q must hold real numbers, not complex128"),
        ((q, v > 0), "rate: v must hold real numbers, not bool"),
        ((q, v, None, np.zeros(3)), r"rate: t must have the shape \(1,\), not \(3,\)"),
        ((q, v, None, "noon"), "rate: t is no array of numbers"),
        ((None, v), "rate: q is no array of numbers"),
        ((q, v, None, 0.0, {"g": 9.81}), "rate: p is no array of numbers"),
    ):
        with pytest.raises(InputError, match=says):
            made.rate(*arguments)


def test_vmap_takes_groups_without_numbers() -> None:
    at, made, (q, v, u, t, p) = functions("drive")  # no degree of freedom, no inputs, no parameters
    assert not len(v) + len(u) + len(p)
    none = np.zeros((3, 0))
    found = jax.vmap(made.rate, (None, 0, 0, None, 0))(q, none, none, t, none)
    assert np.array_equal(found, np.tile(made.rate(q, v, u, t, p), (3, 1)))
    slopes = jax.vmap(jax.jacfwd(made.rate), (None, 0, 0, None, 0))(q, none, none, t, none)
    expected = at.model.derivatives.rate(at.state).A[:, : len(q)]
    np.testing.assert_allclose(slopes, np.tile(expected, (3, 1, 1)), rtol=1e-12, atol=1e-12)
