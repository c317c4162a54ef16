"""The benchmark as a whole: every part is there, ratios refer to this package, tables and JSON hold what was found."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from nullbody.bench import PARTS, Benchmark, Settings
from nullbody.bench.accuracy import DISTANCES
from nullbody.bench.baseline import BASELINES
from nullbody.bench.benchmark import steps
from nullbody.bench.pair import PAPER, pairs
from nullbody.bench.peer import Lap
from nullbody.bench.result import Pair, Row
from nullbody.bench.symbolic import peer_rows, referred, robot_heats
from nullbody.bench.table import duration, figure, pair_table, row_table, tables
from nullbody.bench.timing import Timing
from nullbody.errors import InputError, UnknownName


def test_every_part_is_there(found: Benchmark) -> None:
    assert {row.part for row in found.rows} == set(PARTS) - {"accuracy"}
    assert {row.method for row in found.of("numeric")} >= set(BASELINES)
    assert {entry.method for entry in found.accuracy} >= set(BASELINES)
    assert len(found.worst) > 5


def test_results_are_right_or_say_so(found: Benchmark) -> None:
    for row in found.rows:
        if row.residual is not None and "wrong" not in row.note:
            assert row.residual < 1e-10, row
    wrong = {row.method for row in found.rows if "wrong" in row.note}
    assert all("SymEngine" in method for method in wrong)


def test_ratios_refer_to_one_row_of_this_package(found: Benchmark) -> None:
    for matrix in {row.matrix for row in found.rows}:
        (reference,) = (row for row in found.rows if row.matrix == matrix and row.reference)
        assert reference.kind == "ours" and reference.ratio == 1 and reference.time is not None
        for row in found.rows:
            if row.matrix == matrix and row.time is not None:
                assert row.ratio == pytest.approx(row.time.median / reference.time.median)


def test_fixed_columns_lose_the_subspace_and_chosen_ones_do_not(found: Benchmark) -> None:
    errors = {entry.method: entry.errors for entry in found.accuracy}
    assert set(found.deltas) == set(DISTANCES)
    for method in ("Gauss-Jordan", "determinants", "nullbody compiled, N"):
        assert errors[method][1e-2] < 1e-13 < 1e-7 < errors[method][1e-12]
    for method in ("Wehage-Haug", "Singh-Likins", "nullbody.null_space, columns it chooses"):
        assert max(errors[method].values()) < 1e-13


def test_tables_and_json_hold_the_figures(found: Benchmark) -> None:
    made = tables(found)
    assert all(len(row) == len(table.head) for table in made for row in table.rows)
    assert {table.part for table in made} == {"paper", *PARTS}
    text = json.dumps(found.to_dict())
    assert "nullbody compiled, 8-wide: A to N" in text and '"seconds"' in text
    assert json.loads(text)["settings"]["chains"] == [1, 2]


def test_the_papers_tables() -> None:
    rows = [Row("symbolic", "3-PRS trigonometric", "N", "ours", time=Timing(0.01, 0.0), reference=True)]
    key = "three_prs_trigonometric"
    stopped = Lap(None, None, 5.0, note="not finished within 5 s")
    laps = {(key, "gauss_jordan"): stopped, (key, "cramer_solve"): Lap(2.0, 1e-16, 5.0, 10)}
    table = pair_table(3, pairs(rows, laps))
    assert table.rows[0][1:4] == ("298.1 s", "2.16 s", "138")
    assert table.rows[1][1:4] == ("> 5 s", "2 s", "> 2.5")
    assert table.rows[2][1:4] == ("> 5 s", "10 ms", "> 500")
    assert pairs([], {}) == () and PAPER[1].ratio == pytest.approx(3.76, abs=0.01)


def test_peers_are_judged() -> None:
    own = [Row("symbolic", "chain of 1, relative", "N", "ours", time=Timing(0.1, 0.0), reference=True)]
    laps = {
        ("relative_chain:1", "lu_solve"): Lap(0.2, 0.5, 1.0, 7),
        ("relative_chain:1", "rref"): Lap(0.2, None, 1.0, 7),
        ("relative_chain:1", "nullspace"): Lap(None, None, 1.0, note="not finished within 1 s"),
    }
    rows = {row.method: row for row in peer_rows("symbolic", laps, own)}
    assert rows["SymPy Matrix.LUsolve"].note == "wrong: |A N| = 0.5"
    assert rows["SymPy Matrix.rref()"].note == "wrong: not finite at the sample"
    assert (rows["SymPy Matrix.nullspace()"].ratio, rows["SymPy Matrix.nullspace()"].bound) == (10, True)
    assert referred(Lap(None, None, 1.0, note="failed: x"), "chain of 1, relative", own) == (None, False)


def test_settings_choose_parts_and_limits() -> None:
    quick = Settings.quick()
    assert quick.only(["random", "numeric"]).parts == ("numeric", "random")
    assert quick.limited(0.5).limit == 0.5
    assert sum(len(heat.matrices) for heat in robot_heats(Settings.full())) == 30
    assert len(robot_heats(quick)) < len(robot_heats(Settings.full()))
    assert steps(quick.only(["numeric"])) == 2
    with pytest.raises(UnknownName, match="did you mean 'chains'"):
        quick.only(["chain"])
    for wrong in (-1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="time limit"):
            quick.limited(wrong)


def test_words_of_figures() -> None:
    assert [duration(x) for x in (1.13e-8, 2.3e-4, 298.14, 9.996e-7)] == ["11.3 ns", "230 µs", "298.1 s", "1 µs"]
    assert [figure(x) for x in (0.01234, 1.266, 31438.0, 999.7)] == ["0.0123", "1.27", "31 400", "1 000"]
    row = Row("symbolic", "m", "a", "peer", ratio=7.0, bound=True, note="not finished within 2 s")
    assert row_table("symbolic", "m", [row]).rows == (("a", "> 7", "", "", "", "", "not finished within 2 s"),)
    assert replace(Pair(4, "x", 2.0, 1.0), bound=True).ratio == 2
