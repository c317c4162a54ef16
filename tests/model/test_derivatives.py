"""Exact partial derivatives against complex steps of the interpreter and differences of the native kernels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody import Equations, InputError, catalog, derive
from nullbody.equations import flat
from nullbody.expr import calculus, jacobian, operations
from nullbody.kernels import interpret
from nullbody.mechanism import Mechanism
from nullbody.model import rate_jacobian
from nullbody.model.jacobian_programs import jacobian_program
from nullbody.model.sensitivity import Sensitivity
from tests.mechanisms import four_bar
from tests.model.derivative_cases import CASES, QUICK, agree, case, complex_steps


def time_column(steps: dict[str, np.ndarray], rows: int) -> np.ndarray:
    return steps["t"][:, 0] if "t" in steps else np.zeros(rows)


# -- partial derivatives, all coordinates free ------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_forward_dynamics_equals_complex_steps(name: str) -> None:
    at = case(name)
    found = at.model.derivatives.forward_dynamics(at.state, at.u)
    steps = complex_steps(at.program("forward_dynamics"), at.groups("forward_dynamics"), ("q_ddot",))
    np.testing.assert_allclose(found.q_ddot, at.model.forward_dynamics(at.state, at.u), rtol=1e-11, atol=1e-11)
    for part, group in ((found.q, "q"), (found.v, "v"), (found.u, "u"), (found.p, "p")):
        agree(part, steps[group])
    agree(found.t, time_column(steps, len(found.t)))


@pytest.mark.parametrize("name", CASES)
def test_inverse_dynamics_equals_complex_steps(name: str) -> None:
    at = case(name)
    found = at.model.derivatives.inverse_dynamics(at.state, at.v_dot)
    exact = len(at.model.inputs) == len(at.model.independent)
    steps = complex_steps(at.program("inverse_dynamics"), at.groups("inverse_dynamics"), ("u" if exact else "Qr",))
    value = at.model.inverse_dynamics if exact else at.model.generalized_forces
    np.testing.assert_allclose(found.force, value(at.state, at.v_dot), rtol=1e-11, atol=1e-11)
    for part, group in ((found.q, "q"), (found.v, "v"), (found.v_dot, "v_dot"), (found.p, "p")):
        agree(part, steps[group])
    agree(found.t, time_column(steps, len(found.t)))


@pytest.mark.parametrize("name", QUICK)
def test_rate_equals_differences_of_the_kernel(name: str) -> None:
    at = case(name)
    model = at.model
    found = model.derivatives.rate(at.state, at.u)
    groups = at.groups("forward_dynamics")

    def rate(values: list[np.ndarray]) -> np.ndarray:
        q_ddot, q_dot, *_ = model.library.kernels["forward_dynamics"](*values)
        return np.concatenate([q_dot, q_ddot[model.independent_columns]])

    np.testing.assert_allclose(found.rate, rate(groups), rtol=1e-11, atol=1e-11)
    t = [found.t[:, None]] if model.rheonomic else []
    expected = np.hstack([found.A, found.B, *t, found.p])
    columns = []
    for place, group in enumerate(groups):
        for k in range(len(group)):
            h = 1e-4 * abs(group[k]) if group is groups[-1] and group[k] else 1e-5
            moved = [np.where(np.arange(len(group)) == k, group + way * h, group) for way in (2, 1, -1, -2)]
            far, near, back, behind = (rate([*groups[:place], m, *groups[place + 1 :]]) for m in moved)
            columns.append((8 * (near - back) - (far - behind)) / (12 * h))
    agree(np.array(columns).T, expected, 1e-7)
    if not model.rheonomic:
        assert not found.t.any()


@pytest.mark.parametrize("name", QUICK)
def test_off_the_manifold_they_are_those_of_the_formula(name: str) -> None:
    at = case(name)
    kernel = at.model.derivatives.kernel("rate")
    groups = at.groups("forward_dynamics")
    groups[0] = groups[0] + 0.01 * at.draw.normal(size=len(groups[0]))
    found = dict(zip((key for key, _ in kernel.program.outputs), kernel(*groups), strict=True))
    steps = complex_steps(at.program("forward_dynamics"), groups, ("q_dot",))
    nq = len(groups[0])
    agree(found["A"][:nq], np.hstack([steps["q"], steps["v"]]))
    steps = complex_steps(at.program("forward_dynamics"), groups, ("q_ddot",))
    rows = at.model.independent_columns
    agree(found["A"][nq:], np.hstack([steps["q"][rows], steps["v"][rows]]))


@pytest.mark.parametrize("name", ["four_bar", "cart", "drive", "flyball_governor", "three_prs"])
def test_rate_jacobian_of_the_stiff_method_has_the_power_too(name: str) -> None:
    at = case(name)
    steps = complex_steps(at.program("forward_dynamics"), at.groups("forward_dynamics"), ("q_ddot", "q_dot", "power"))
    nq, model = len(at.state.q), at.model
    rows = [*range(nq, 2 * nq), *model.independent_columns, 2 * nq]
    expected = np.hstack([steps["q"], steps["v"]])[rows]
    agree(rate_jacobian(model, at.state.q, at.v, at.u, at.state.t), expected)


def test_parameters_can_be_left_out() -> None:
    at = case("three_prs")
    derivatives = at.model.derivatives
    for whole, part in (
        (derivatives.rate(at.state, at.u), derivatives.rate(at.state, at.u, parameters=False)),
        (derivatives.forward_dynamics(at.state), derivatives.forward_dynamics(at.state, parameters=False)),
        (
            derivatives.inverse_dynamics(at.state, at.v_dot),
            derivatives.inverse_dynamics(at.state, at.v_dot, parameters=False),
        ),
        (derivatives.step(at.state, at.u, 0.01), derivatives.step(at.state, at.u, 0.01, parameters=False)),
    ):
        assert part.p.shape == (len(part[0]) if part[0].ndim and part.p.shape[0] != 15 else 15, 0)
        for left, right in zip(whole[:-1], part[:-1], strict=True):
            np.testing.assert_allclose(left, right, rtol=1e-12, atol=1e-12)


def derived(mechanism: Mechanism, independent: Any = None) -> Equations:
    """Equations written in the rates of the independent coordinates, as `jacobian_program` takes them."""
    names = independent or derive(mechanism).independent
    return derive(mechanism, names, basis=names)


@pytest.mark.parametrize("name", ["four_bar", "three_prs", "rolling_disc", "cart", "two_bodies"])
def test_the_expressions_are_those_of_the_differentiated_solution_exactly(name: str) -> None:
    """Equal at a random point of the prime field: the differentials of the equations against v' differentiated."""
    make, independent, _ = CASES[name]
    equations = derived(make(), independent)
    graph, routine = equations.graph, equations.routines["forward_dynamics"].outputs

    def symbols(*groups: str) -> list[Any]:
        return [graph.symbol(s) for group in groups for s in equations.groups[group]]

    by_x, by_v, by_u = (jacobian(list(routine["q_ddot"]), symbols(*g)) for g in (("q", "t", "p"), ("v",), ("u",)))
    rates = jacobian(list(routine["q_dot"]), symbols("q", "t", "p"))
    at = Sensitivity(equations, symbols("q", "t", "p"), routine["q_ddot"], symbols("u"))
    v_dot_x, v_dot_v = ([[-entry for entry in row] for row in at.accelerated(forces)] for forces in (at.R_x, at.R_v))
    for found, expected in (
        (at.q_dot_x, rates),
        (at.q_ddot_x(v_dot_x), by_x),
        (at.q_ddot_v(v_dot_v), by_v),
        (at.q_ddot_u(at.accelerated(at.Br)), by_u),
    ):
        exact = [[graph.value((at.zero + entry).ref) for entry in row] for row in found]
        assert exact == [[graph.value(entry.ref) for entry in row] for row in expected]


# -- operations -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "share"), [("three_prs", 0.5), ("n_four_bar", 0.6), ("stewart_platform", 0.3)])
def test_far_fewer_operations_than_differentiating_the_solution(name: str, share: float) -> None:
    make, independent, _ = CASES[name]
    plain = derived(make(), independent)
    routine = plain.routines["forward_dynamics"].outputs
    symbols = [plain.graph.symbol(s) for group in ("q", "v", "u") for s in plain.groups[group]]
    v_dot = [routine["q_ddot"][plain.coordinates.index(s)] for s in plain.independent]
    rows = jacobian([*routine["q_dot"], *v_dot], symbols)
    forward_mode = operations([*flat(rows), *routine["q_dot"], *v_dot]).arithmetic
    made = jacobian_program(derived(make(), independent), "rate", parameters=False)
    assert made.tape.operations.arithmetic < share * forward_mode


def test_operations_grow_with_the_mechanism_as_its_entries_do() -> None:
    counts = []
    for n in (2, 4, 8):
        made = jacobian_program(derived(catalog.n_four_bar(n)), "rate", parameters=False)
        counts.append(made.tape.operations.arithmetic)
    assert counts[2] / counts[1] < 4.5  # A has (2n + 2)^2 entries


@pytest.mark.parametrize("operation", ["mul", "sin", "add"])
def test_a_planted_sign_error_is_caught(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    at = case("four_bar")
    expected = complex_steps(at.program("forward_dynamics"), at.groups("forward_dynamics"), ("q_ddot",))
    right = calculus._tangent

    def wrong(graph: Any, node: int, tangent: dict[int, int]) -> int:
        ref = right(graph, node, tangent)
        return graph.negate(ref) if graph.code[node][0] == operation else ref

    def found() -> np.ndarray:
        program = jacobian_program(derived(four_bar(), ("q1",)), "forward_dynamics", parameters=False)
        values = interpret(program, *at.groups("forward_dynamics"))
        return dict(zip((key for key, _ in program.outputs), values, strict=True))["q_ddot_q"]

    agree(found(), expected["q"])
    equations = derived(four_bar(), ("q1",))  # rightly; only the derivatives of it are wrong
    monkeypatch.setattr(calculus, "_tangent", wrong)
    program = jacobian_program(equations, "forward_dynamics", parameters=False)
    values = interpret(program, *at.groups("forward_dynamics"))
    with pytest.raises(AssertionError):
        agree(dict(zip((key for key, _ in program.outputs), values, strict=True))["q_ddot_q"], expected["q"])


def test_arguments_that_make_no_sense_are_named() -> None:
    derivatives = case("four_bar").model.derivatives
    for parameters in ([], "no", None, 1):
        with pytest.raises(InputError, match="parameters must be True or False"):
            derivatives.rate(case("four_bar").state, parameters=parameters)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"there is no parameter \[\]"):
        derivatives.following([])  # type: ignore[arg-type]
