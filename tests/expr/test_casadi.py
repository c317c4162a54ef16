"""Tapes as CasADi functions: their values and derivatives against the model's."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

from nullbody import Equations, InputError, Model, assemble, build, catalog, derive
from nullbody.expr import Graph, Tape, cos, sin, sqrt
from nullbody.expr.casadi_writer import casadi_function
from tests.mechanisms import four_bar

casadi = pytest.importorskip("casadi", reason="CasADi is not installed: pip install casadi")


@pytest.fixture(scope="module", params=["four_bar", "three_prs", "rolling_disc"])
def made(request: pytest.FixtureRequest) -> tuple[Equations, Model, dict[str, Any]]:
    start = next(iter(catalog.starts(request.param).values()))
    equations = derive(start.mechanism)
    return equations, build(equations), equations.to_casadi()


def dense(matrix: Any) -> np.ndarray:
    return np.array(matrix.full())


def test_values_equal_those_of_the_kernels(made: tuple[Equations, Model, dict[str, Any]]) -> None:
    equations, model, functions = made
    assert set(functions) == set(equations.routines)
    draw = np.random.default_rng(1)
    home = np.array(list(model.mechanism.home_values(model.parameters).values()))
    for name, function in functions.items():
        kernel = model.library.kernels[name]
        groups = {
            group: home + 0.01 * draw.normal(size=size) if group == "q" else draw.normal(size=size)
            for group, size in kernel.program.inputs
        }
        groups["p"] = np.array(model.values)
        found = function(**groups)
        assert (function.name_in(), function.name_out()) == (
            [group for group, _ in kernel.program.inputs],
            [group for group, _ in kernel.program.outputs],
        )
        for (key, shape), expected in zip(kernel.program.outputs, kernel(*groups.values()), strict=True):
            rows, columns = (*shape, 1, 1)[:2]
            assert found[key].shape == (rows, columns), (name, key)
            scale = max(1.0, np.abs(expected).max(initial=0.0))
            np.testing.assert_allclose(dense(found[key]), expected.reshape(rows, columns), rtol=0, atol=1e-9 * scale)


def test_casadis_own_derivatives_equal_the_models(made: tuple[Equations, Model, dict[str, Any]]) -> None:
    _, model, functions = made
    function = functions["forward_dynamics"]
    start = next(iter(catalog.starts(model.mechanism.name).values()))
    draw = np.random.default_rng(2)
    state = model.state(start.q, draw.normal(size=len(model.independent)))
    u = draw.normal(size=len(model.inputs))
    symbols = {group: casadi.SX.sym(group, size) for group, size in (("q", len(state.q)), ("v", len(state.v)))}
    y = function(**symbols, u=u, p=list(model.values))["q_ddot"]
    slopes = [casadi.Function("slope", list(symbols.values()), [casadi.jacobian(y, x)]) for x in symbols.values()]
    expected = model.derivatives.forward_dynamics(state, u, parameters=False)
    for slope, part in zip(slopes, (expected.q, expected.v), strict=True):
        scale = max(1.0, np.abs(part).max())
        np.testing.assert_allclose(dense(slope(state.q, state.v)), part, rtol=0, atol=1e-10 * scale)


def test_the_time_is_an_input_where_it_enters() -> None:
    from tests.model.derivative_cases import case

    at = case("cart")
    function = at.equations.to_casadi()["forward_dynamics"]
    assert function.name_in() == ["q", "v", "u", "t", "p"]
    found = function(*at.groups("forward_dynamics"))[0]
    np.testing.assert_allclose(dense(found)[:, 0], at.model.forward_dynamics(at.state, at.u), rtol=1e-11)


def test_a_second_derivative_equals_differences_of_the_models_first() -> None:
    equations = derive(four_bar(), ("q1",))
    model = build(equations)
    q, p = casadi.SX.sym("q", 3), list(model.values)
    y = equations.to_casadi()["forward_dynamics"](q=q, v=[0.4], u=[0.2], p=p)["q_ddot"]
    hessian = casadi.Function("hessian", [q], [casadi.hessian(y[0], q)[0]])
    state, h = assemble(model, {"q1": 1.1}, [0.4]), 1e-5

    def slope(k: int, way: int) -> np.ndarray:
        moved = model.trusted_state(state.q + way * h * (np.arange(3) == k), state.v.copy())
        return model.derivatives.forward_dynamics(moved, [0.2], parameters=False).q[0]

    differences = np.array([(slope(k, 1) - slope(k, -1)) / (2 * h) for k in range(3)])
    np.testing.assert_allclose(dense(hessian(state.q)), differences, rtol=1e-6, atol=1e-6)


def test_every_operation_and_shape_is_written() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    entries = [sin(x) * y, cos(x) - y, 1 / x, sqrt(y), -x, graph.constant(3)]
    tape = Tape.of([*entries, x * y, *entries], ["x", "y"])
    outputs = [("matrix", (2, 3)), ("scalar", ()), ("column", (6,)), ("none", (0,)), ("empty", (2, 0))]
    function = casadi_function("f", tape, [("x", 1), ("nothing", 0), ("y", 1)], outputs)
    matrix, scalar, column, none, empty = function(0.7, [], 2.0)
    expected = [np.sin(0.7) * 2, np.cos(0.7) - 2, 1 / 0.7, np.sqrt(2), -0.7, 3]
    np.testing.assert_allclose(dense(matrix), np.reshape(expected, (2, 3)), rtol=1e-15)
    np.testing.assert_allclose(dense(column)[:, 0], expected, rtol=1e-15)
    assert float(scalar) == pytest.approx(1.4)
    assert (none.shape, empty.shape) == ((0, 1), (2, 0))


def test_sizes_that_do_not_fit_are_refused() -> None:
    tape = Tape.of([Graph().symbol("x")], ["x"])
    with pytest.raises(InputError, match="f: groups of 2 inputs and 1 outputs do not fit a tape with 1 and 1"):
        casadi_function("f", tape, [("x", 2)], [("y", ())])


def test_without_casadi_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(InputError, match=r"CasADi is not installed; run: python -m pip install 'nullbody\[optimal\]'"):
        derive(four_bar(), ("q1",)).to_casadi()
