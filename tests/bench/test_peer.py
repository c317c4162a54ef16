"""Other tools get the right matrix, are judged by the residual, and are stopped at their limit."""

from __future__ import annotations

import json

import numpy as np
import pytest

from nullbody import catalog, derive
from nullbody.bench.matrix import relative_chain, three_prs_trigonometric
from nullbody.bench.peer import PEERS, Heat, Lap, Race, process
from nullbody.bench.peer.given import written
from nullbody.bench.peer.process import named_matrix
from nullbody.bench.peer.tree import evaluated, operations
from nullbody.expr import Exact


def ran(capsys: pytest.CaptureFixture[str], method: str, matrix: str) -> dict:
    """What a method prints of a matrix, in this process."""
    if PEERS[method].missing:
        pytest.skip(PEERS[method].missing)
    process.main(method, matrix)
    ready, first, last = capsys.readouterr().out.splitlines()
    assert ready == "ready" and json.loads(first)["seconds"] > 0
    return json.loads(last)


def test_written_matrix_is_the_robots() -> None:
    sympy = pytest.importorskip("sympy")
    matrix = three_prs_trigonometric()
    values = matrix.sample(np.random.default_rng(0), 1)
    functions = {"sin": sympy.sin, "cos": sympy.cos}
    A = written(matrix, sympy.Symbol, lambda number: sympy.Float(float(number), 17), functions)
    known = dict(zip(map(sympy.Symbol, matrix.inputs), values[0], strict=True))
    assert np.abs(evaluated(A, known) - matrix.numbers(values)[0]).max() < 1e-15
    assert derive(catalog.three_prs()).coordinates == matrix.inputs[:12]


SOLVERS = ("lu_solve", "domain_nullspace", "domain_adjugate", "rref", "gauss_jordan", "cramer_solve", "flint_minors")


@pytest.mark.parametrize("method", [*SOLVERS, *(name for name in PEERS if "symengine" in name or "casadi" in name)])
def test_peer_is_right_on_a_chain(capsys: pytest.CaptureFixture[str], method: str) -> None:
    found = ran(capsys, method, "relative_chain:1")
    assert found["residual"] < 1e-14
    assert 9 <= found["operations"] <= 60


@pytest.mark.parametrize(
    ("method", "right"), [("by_value", True), ("structural", False), ("symengine_lu", False), ("casadi_solve", True)]
)
def test_fixed_order_does_not_see_the_hidden_zero(capsys: pytest.CaptureFixture[str], method: str, right: bool) -> None:
    residual = ran(capsys, method, "three_prs_trigonometric")["residual"]
    assert (residual is not None and residual < 1e-13) is right


def test_flint_sees_sines_as_symbols(capsys: pytest.CaptureFixture[str]) -> None:
    found = ran(capsys, "flint_minors", "three_prs_trigonometric")
    assert found["residual"] < 1e-14 and found["operations"] > 1000


def test_operations_count_shared_parts_once() -> None:
    sympy = pytest.importorskip("sympy")
    x, y, z = sympy.symbols("x y z")
    assert operations([x * y + 1]) == 2
    assert operations([(x + y) ** 2, z * (x + y)]) == 3
    assert operations([x / y, 2 / y]) == 3
    assert operations([-x, sympy.sqrt(3), sympy.sin(x)]) == 0
    assert operations([sympy.sqrt(x), x**-2, x**5]) == 1 + 2 + 3


def test_matrices_have_names() -> None:
    assert named_matrix("relative_chain:3").shape == relative_chain(3).shape
    assert named_matrix("random_dense:2:5").shape == (2, 5)
    assert Exact.of(1) == named_matrix("absolute_chain:1").rows[0][0].constant


def test_race_stops_at_the_limit_and_leaves_out_what_is_harder() -> None:
    pytest.importorskip("sympy")
    laps = Race([Heat("nullspace", ("three_prs_generic", "relative_chain:1"), 0.1)]).start().results()
    first, second = laps["three_prs_generic", "nullspace"], laps["relative_chain:1", "nullspace"]
    assert first.seconds is None and first.stopped and first.note == "not finished within 0.1 s"
    assert second.note == "not tried: three_prs_generic took too long" and not second.stopped


def test_race_finishes_side_by_side() -> None:
    pytest.importorskip("symengine")
    heats = [Heat("symengine_lu", ("relative_chain:1", "relative_chain:2"), 60), Heat("casadi_solve", (), 60)]
    laps = Race(heats, workers=2).start().results()
    assert [lap.operations for lap in laps.values()] == [13, 32]
    assert all(lap.residual is not None and lap.residual < 1e-14 for lap in laps.values())


def test_race_says_why_there_is_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    idle = Race([Heat("lu_solve", ("a", "b"), 0.0)]).start().results()
    assert [lap.note for lap in idle.values()] == ["no time was given"] * 2
    failed = Race([Heat("lu_solve", ("relative_chain:x",), 5.0)]).start().results()
    assert failed["relative_chain:x", "lu_solve"].note.startswith("failed: ValueError")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    missing = Race([Heat("flint_minors", ("relative_chain:1",), 5.0)]).start().results()
    assert missing["relative_chain:1", "flint_minors"].note == "not installed: python -m pip install python-flint"


def test_race_can_be_stopped() -> None:
    pytest.importorskip("sympy")
    race = Race([Heat("gauss_jordan", ("three_prs_generic",), 600.0)]).start()
    race.stop()
    assert all(isinstance(lap, Lap) and lap.seconds is None for lap in race.results().values())
