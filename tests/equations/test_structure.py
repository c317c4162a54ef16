"""Sizes, sparsity, operation counts and determinism of the robot's equations."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from nullbody.catalog import three_prs
from nullbody.equations import Equations, derive, flat, shape
from nullbody.errors import UnknownName
from nullbody.expr import Expr, Graph

#: Exact operation counts (additions, multiplications, divisions, square roots) of what is shipped. Only lower them.
OUTPUTS = {
    "Phi": 73,
    "A": 65,
    "b": 0,
    "c": 128,
    "M": 34,
    "h": 78,
    "Q": 0,
    "T": 90,
    "U": 17,
    "delta": 106,
    "N": 278,
    "N_scaled": 282,
    "beta": 0,
    "gamma": 446,
    "gamma_scaled": 450,
    "Mr": 482,
    "hr": 674,
    "Br": 0,
}
ROUTINES = {
    "closure": 114,
    "redundant": 0,
    "facing": 0,
    "rows": 65,
    "kinematics": 647,
    "forward_dynamics": 954,
    "inverse_dynamics": 934,
    "closing": 537,
    "reactions": 486,
    "energy": 101,
}
ALONE = {("forward_dynamics", "q_ddot"): 779, ("inverse_dynamics", "u"): 618, ("kinematics", "N"): 278}
CHARTS = {  # independent and basis -> q'', forward_dynamics, u, inverse_dynamics; shown in docs/performance.md
    (("s1", "s2", "s3"), ("s1", "s2", "s3")): (978, 1130, 771, 1036),
    (("y", "psi", "theta"), ("y", "psi", "theta")): (674, 793, 519, 744),
}
SHAPES = {
    "Phi": (9,),
    "A": (9, 12),
    "b": (9,),
    "c": (9,),
    "M": (12, 12),
    "h": (12,),
    "Q": (12,),
    "T": (),
    "U": (),
    "delta": (),
    "N": (12, 3),
    "N_scaled": (12, 3),
    "beta": (12,),
    "gamma": (12,),
    "gamma_scaled": (12,),
    "Mr": (3, 3),
    "hr": (3,),
    "Br": (3, 3),
}


def test_outputs_and_their_shapes(three_prs_equations: Equations) -> None:
    assert {name: shape(three_prs_equations[name]) for name in three_prs_equations.outputs} == SHAPES


def test_operation_counts(three_prs_equations: Equations) -> None:
    eq = three_prs_equations
    assert {name: eq.operations(name).arithmetic for name in eq.outputs} == OUTPUTS
    assert {name: eq.routine_operations(name).arithmetic for name in eq.routines} == ROUTINES
    assert {key: eq.routine_operations(*key).arithmetic for key in ALONE} == ALONE
    assert eq.basis == ("alpha1", "alpha2", "alpha3")


@pytest.mark.parametrize("chart", CHARTS)
def test_operation_counts_of_charts(chart: tuple[tuple[str, ...], tuple[str, ...]]) -> None:
    independent, basis = chart
    eq = derive(three_prs(), independent, basis=basis)
    parts = (("forward_dynamics", "q_ddot"), ("forward_dynamics",), ("inverse_dynamics", "u"), ("inverse_dynamics",))
    assert tuple(eq.routine_operations(*part).arithmetic for part in parts) == CHARTS[chart]


def test_shared_nodes_count_once(three_prs_equations: Equations) -> None:
    alone = [three_prs_equations.operations(name).arithmetic for name in ("N", "delta")]
    assert three_prs_equations.operations("N", "delta").arithmetic <= alone[0] + 2 < sum(alone)
    assert three_prs_equations.operations().trig == 12  # sine and cosine of six angles


def test_only_one_division_in_n_and_none_in_the_scaled_forms(three_prs_equations: Equations) -> None:
    assert three_prs_equations.operations("N").div == 1
    assert three_prs_equations.operations("N_scaled", "gamma_scaled", "delta", "M", "h", "A", "c").div == 0
    assert three_prs_equations.operations().sqrt == 0


def test_the_jacobian_has_46_non_zeros_of_108(three_prs_equations: Equations) -> None:
    A = three_prs_equations["A"]
    assert sum(entry != 0 for entry in flat(A)) == 46
    for i, row in enumerate(A):
        assert [entry.constant is not None for entry in row[:3]] == [True] * 3
        assert row[i % 3] == -1
        assert all(row[6 + leg] == 0 and row[9 + leg] == 0 for leg in range(3) if leg != i // 3)


def test_the_mass_matrix_is_nearly_block_diagonal(three_prs_equations: Equations) -> None:
    M = three_prs_equations["M"]
    coupled = {(i, j) for i in range(12) for j in range(i + 1, 12) if M[i][j] != 0}
    assert coupled <= {(3, 4), (3, 5), (4, 5), (6, 9), (7, 10), (8, 11)}
    assert {(6, 9), (7, 10), (8, 11)} <= coupled  # -m (l/2) sin(alpha_i), missing in the paper's [35]


def test_labels_name_the_loops(three_prs_equations: Equations) -> None:
    assert three_prs_equations.labels == tuple(f"leg{i} {direction}" for i in (1, 2, 3) for direction in "xyz")
    assert three_prs_equations.redundant == ()
    assert three_prs_equations.dependent == three_prs_equations.coordinates[:9]


def test_every_symbol_is_an_input(three_prs_equations: Equations) -> None:
    eq = three_prs_equations
    for name, routine in eq.routines.items():
        allowed = {symbol for group in (*routine.inputs, "p") for symbol in eq.groups[group]}
        used = _leaves(routine.expressions)
        assert used <= allowed, f"{name} needs {used - allowed}"


def _leaves(expressions: list[Expr]) -> set[str]:
    graph = expressions[0].graph if expressions else Graph()
    nodes = [graph.code[n] for n in graph.reachable(f.ref for f in expressions)]
    return {graph.symbols[a] for op, a, _ in nodes if op == "symbol"}


def test_unknown_outputs_suggest_the_nearest(three_prs_equations: Equations) -> None:
    with pytest.raises(UnknownName, match="no output 'N_scale'; did you mean 'N_scaled'"):
        three_prs_equations["N_scale"]
    with pytest.raises(UnknownName, match="no routine 'inverse'; did you mean 'inverse_dynamics'"):
        three_prs_equations.routine_operations("inverse")


PRINT_TAPE = """
from hashlib import sha256
from nullbody.catalog import three_prs
from nullbody.equations import derive, flat
from nullbody.expr import Tape
eq = derive(three_prs(), ("s1", "s2", "s3"))
names = tuple(eq.graph.symbols)
parts = [[f for output in eq.outputs.values() for f in flat(output)], *(r.expressions for r in eq.routines.values())]
print(sha256(repr([Tape.of(part, names) for part in parts]).encode()).hexdigest())
print(sha256((str(eq) + eq.latex("N_scaled")).encode()).hexdigest())
"""


def test_two_processes_derive_the_same_program() -> None:
    printed = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        run = subprocess.run(
            [sys.executable, "-c", PRINT_TAPE], capture_output=True, text=True, env=environment, check=True
        )
        printed.append(run.stdout)
    assert printed[0] == printed[1]
    assert len(printed[0].split()) == 2
