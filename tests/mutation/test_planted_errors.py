"""The oracles are tested themselves: each must fail on a planted sign error, and pass without it."""

from __future__ import annotations

from typing import Any

import pytest

from nullbody.equations import Equations, flat
from nullbody.expr import Expr, Tape, sin
from tests.mutation.plant import changed, flipped, instructions, link_energy, terms
from tests.oracles import check
from tests.oracles.sample import all_outputs, arranged, evaluate, sample

MOTION = 3  # the seed of the motion on which errors are planted


def _caught(oracle: Any, outputs: dict[str, Any]) -> None:
    motion = sample(MOTION)
    with pytest.raises(AssertionError):
        oracle(evaluate(outputs, motion.values), motion)


@pytest.fixture
def outputs(three_prs_equations: Equations) -> dict[str, Any]:
    found = all_outputs(three_prs_equations)
    motion = sample(MOTION)
    check.everything(evaluate(found, motion.values), motion)
    return found


@pytest.mark.parametrize("i", range(9))
def test_the_sign_of_gamma(i: int, outputs: dict[str, Any]) -> None:
    _caught(check.offset, changed(outputs, "gamma", (i,), -outputs["gamma"][i]))
    _caught(check.offset, changed(outputs, "gamma_scaled", (i,), -outputs["gamma_scaled"][i]))
    _caught(check.dynamics, changed(outputs, "kinematics.gamma", (i,), -outputs["kinematics.gamma"][i]))


def test_gamma_in_an_independent_place(outputs: dict[str, Any]) -> None:
    """The paper's [41], the pseudo-inverse's gamma: A gamma + c = 0, but the independent rows are not zero."""
    _caught(check.offset, changed(outputs, "gamma", (10,), outputs["c"][0]))


@pytest.mark.parametrize("row", [3, 4, 5])
def test_one_coriolis_term_of_the_platform(row: int, outputs: dict[str, Any]) -> None:
    h = outputs["h"][row]
    coriolis = [term for term in terms(h) if _has_rates(term)]
    assert coriolis
    for term in coriolis:
        _caught(check.inertia, changed(outputs, "h", (row,), h - 2 * term))
        _caught(check.power, changed(outputs, "h", (row,), h - 2 * term))


@pytest.mark.parametrize("row", [6, 7, 8, 9, 10, 11])
def test_one_term_of_a_legs_forces(row: int, outputs: dict[str, Any]) -> None:
    for term in terms(outputs["h"][row]):
        _caught(check.inertia, changed(outputs, "h", (row,), outputs["h"][row] - 2 * term))


def _has_rates(term: Expr) -> bool:
    graph = term.graph
    mask = graph.depends[term.ref >> 1]
    return any(mask >> k & 1 and name.endswith("_dot") for k, name in enumerate(graph.symbols))


@pytest.mark.parametrize("i", range(9))
@pytest.mark.parametrize("j", range(3))
def test_one_numerator_of_the_scaled_null_space(i: int, j: int, outputs: dict[str, Any]) -> None:
    for name in ("N_scaled", "N"):
        _caught(check.null_space, changed(outputs, name, (i, j), -outputs[name][i][j]))


@pytest.mark.parametrize("link", [1, 2, 3])
def test_the_energy_of_one_link(link: int, outputs: dict[str, Any]) -> None:
    share = link_energy(outputs["T"], link)
    assert share != 0
    _caught(check.energy, changed(outputs, "T", (), outputs["T"] - 2 * share))
    graph = share.graph
    weight = graph.symbol("m") * graph.symbol("g") * graph.symbol("l")
    _caught(check.energy, changed(outputs, "U", (), outputs["U"] - weight * sin(graph.symbol(f"alpha{link}"))))


@pytest.mark.parametrize("i", range(9))
def test_the_sign_of_lambda(i: int, outputs: dict[str, Any]) -> None:
    _caught(check.dynamics, changed(outputs, "reactions.lam", (i,), -outputs["reactions.lam"][i]))


def test_the_sign_of_all_of_lambda_is_caught_although_it_does_no_work(outputs: dict[str, Any]) -> None:
    planted = {**outputs, "reactions.lam": tuple(-entry for entry in outputs["reactions.lam"])}
    _caught(check.dynamics, planted)


def test_every_entry_of_the_jacobian_and_of_c(outputs: dict[str, Any]) -> None:
    for i in range(9):
        for j in range(12):
            if outputs["A"][i][j] != 0:
                _caught(check.closure, changed(outputs, "A", (i, j), -outputs["A"][i][j]))
        for term in terms(outputs["c"][i]):
            _caught(check.closure, changed(outputs, "c", (i,), outputs["c"][i] - 2 * term))


def test_the_shortcuts_of_the_paper(outputs: dict[str, Any]) -> None:
    """m l^2/3 about the centre [29], no coupling of alpha_i and s_i and the sign of gravity [35]."""
    graph = outputs["T"].graph
    m, l, M, g = (graph.symbol(name) for name in ("m", "l", "M", "g"))  # noqa: E741
    _caught(check.inertia, changed(outputs, "M", (6, 6), outputs["M"][6][6] + m * l * l / 4))
    _caught(check.inertia, changed(outputs, "M", (6, 9), graph.constant(0)))
    _caught(check.inertia, changed(outputs, "h", (1,), outputs["h"][1] - 2 * M * g))


def test_a_sign_in_any_instruction_of_the_whole_program(outputs: dict[str, Any]) -> None:
    """Every third operand of all outputs and routines together; an error anywhere must be seen.

    `doubt` is left out: an estimate that only bounds are checked of (tests/model/test_null_space.py).
    """
    motion = sample(MOTION)
    outputs = {name: output for name, output in outputs.items() if not name.endswith(".doubt")}
    right = evaluate(outputs, motion.values)
    inputs = list(motion.values.values())
    missed = []
    for part in _by_graph(outputs):
        tape = Tape.of([f for output in part.values() for f in flat(output)], tuple(motion.values))
        for slot, operand in list(instructions(tape))[::3]:
            found = right | arranged(part, flipped(tape, slot, operand).run(inputs))
            try:
                check.everything(found, motion)
            except AssertionError:
                continue
            missed.append((slot, tape.code[slot]))
    assert not missed


def _by_graph(outputs: dict[str, Any]) -> list[dict[str, Any]]:
    """The outputs that share a graph, without empty ones: those of the dynamics have one of their own."""
    parts: dict[int, dict[str, Any]] = {}
    for name, output in outputs.items():
        expressions = list(flat(output))
        if expressions:
            parts.setdefault(id(expressions[0].graph), {})[name] = output
    return list(parts.values())
