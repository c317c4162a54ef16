"""The methods that the null space is timed against are themselves right, or wrong as the report says."""

from __future__ import annotations

import json

import numpy as np
import pytest

from nullbody.report import symbolic_baseline
from nullbody.report.case import Case
from nullbody.report.native import native_seconds
from nullbody.report.numeric_baseline import METHODS
from nullbody.report.race import Race
from nullbody.report.speed import _kernels


@pytest.mark.parametrize("name", METHODS)
def test_numeric_method_spans_the_null_space(case: Case, name: str) -> None:
    A = case.model.jacobian(case.desired.state(0.3).q)
    N = METHODS[name](A)
    assert N.shape == (12, 3) and np.linalg.matrix_rank(N) == 3
    assert np.abs(A @ N).max() < 1e-13 * np.abs(N).max()


def test_numeric_methods_can_fail(case: Case) -> None:
    A = case.model.jacobian(case.desired.state(0.3).q)
    N = METHODS["Gauss-Jordan, row by row (NumPy)"](A)
    N[4, 1] *= 1 + 1e-6
    assert np.abs(A @ N).max() > 1e-11


def test_kernels_agree_with_the_model(case: Case) -> None:
    state = case.desired.state(0.3)
    A = case.model.jacobian(state.q)
    from_state, from_matrix, eliminated = _kernels(case.equations, A)
    expected = case.model.null_space(state).N
    assert np.abs(from_state(state.q, np.array(case.model.values))[0] - expected).max() < 1e-13
    assert np.abs(from_matrix(A.ravel())[0] - expected).max() < 1e-13
    assert np.abs(eliminated(A.ravel())[0] - expected).max() < 1e-12


def test_native_loop_times_a_kernel(case: Case) -> None:
    rows = np.array([case.model.jacobian(case.desired.state(t).q).ravel() for t in (0.1, 0.2, 0.3)])
    _, kernel, _ = _kernels(case.equations, rows[0].reshape(9, 12))
    assert 0 < native_seconds(kernel, rows, repeats=3, seconds=1e-3) < 1


def test_symbolic_baseline_has_the_robots_matrix(case: Case) -> None:
    sympy = pytest.importorskip("sympy")
    A, symbols = symbolic_baseline.constraint_matrix()
    state = case.desired.state(0.4)
    values = {symbols[name]: value for name, value in {**state.positions, "b": 0.2, "l": 0.5}.items()}
    found = np.array(sympy.Matrix(A).subs(values).evalf(17), dtype=float)
    assert np.abs(found - case.model.jacobian(state.q)).max() < 1e-15


@pytest.mark.parametrize(("method", "right"), [("by_value", True), ("structural", False), ("lu_solve", False)])
def test_only_pivots_by_value_survive_the_hidden_zero(
    capsys: pytest.CaptureFixture[str], method: str, right: bool
) -> None:
    pytest.importorskip("sympy")
    symbolic_baseline.main(method)
    ready, line = capsys.readouterr().out.splitlines()
    residual = json.loads(line)["residual"]
    assert ready == "ready"
    assert (residual is not None and residual < 1e-13) is right


def test_race_stops_at_the_limit() -> None:
    pytest.importorskip("sympy")
    laps = Race({"nullspace": 0.05}).start().results()
    assert laps["nullspace"].seconds is None
    assert laps["nullspace"].note == "not finished within 0.05 s"


def test_race_without_time_names_every_method() -> None:
    laps = Race({"a": 0.0, "b": 0.0}).start().results()
    assert {name: lap.note for name, lap in laps.items()} == {"a": "no time was given", "b": "no time was given"}
