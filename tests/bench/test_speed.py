"""The speed benchmark with little to measure: all subjects, missing peers, JSON, tables, page. No speed is judged."""

from __future__ import annotations

import html
import json
import re
from dataclasses import replace

import pytest

from nullbody.bench.speed import (
    SUBJECTS,
    Curve,
    Effort,
    Goal,
    Growth,
    Line,
    Point,
    Speed,
    bench_speed,
    build,
    dynamics,
    lockstep,
    run,
    scaling,
    steps,
    swing,
)
from nullbody.bench.speed.goal import goals
from nullbody.bench.speed.limit import Limit, machine_limit
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.bench.speed.result import exponent
from nullbody.bench.speed.table import goal_table, tables
from nullbody.bench.timing import Timing
from nullbody.cli.output import json_text
from nullbody.errors import UnknownName
from nullbody.report.bench_page import bench_page

SMALL = Effort(
    repeats=2,
    seconds=1e-4,
    patience=0.01,
    processes=1,
    states=4,
    batch=64,
    duration=0.1,
    tolerances=(1e-4, 1e-8),
    timesteps=(1e-2, 1e-3),
    robots=16,
    chains=(1, 5, 6),
    derivation=60.0,
    thorough=True,
)


@pytest.fixture(scope="module")
def announced() -> list[str]:
    return []


@pytest.fixture(scope="module")
def found(announced: list[str]) -> Speed:
    return bench_speed(SMALL, step=announced.append)


def test_every_subject_is_there(found: Speed, announced: list[str]) -> None:
    assert {line.subject for line in found.lines} == set(SUBJECTS) - {"scaling"}
    assert found.curves and found.growths and len(found.goals) == 10
    assert len(announced) == steps(SMALL, found.subjects)


def test_every_work_has_one_reference_and_ratios_to_it(found: Speed) -> None:
    for work in {line.work for line in found.lines}:
        own = [line for line in found.lines if line.work == work]
        (reference,) = (line for line in own if line.reference)
        assert reference.kind == "ours" and reference.ratio == 1
        assert all(line.ratio is not None and line.ratio > 0 for line in own if line.time is not None)


def test_results_agree(found: Speed) -> None:
    """Exact tools to rounding, single precision and soft closures to theirs."""
    for line in found.lines:
        if line.deviation is not None:
            assert line.deviation < (1e-2 if "soft" in line.tool else 1e-3 if "float32" in line.tool else 1e-9), line
    for growth in found.growths:
        assert growth.deviation is None or growth.deviation < (1e-2 if "soft" in growth.tool else 1e-9), growth


def test_the_swing_converges_to_the_reference(found: Speed) -> None:
    curves = {curve.tool: [point.error for point in curve.points] for curve in found.curves}
    assert curves["nullbody.simulate"][1] < 1e-7 and curves["nullbody.simulate"][1] < curves["nullbody.simulate"][0]
    away = re.findall(r"ends ([0-9.e+-]+) from it", found.facts["reference of the swing"])
    assert away and max(map(float, away)) < 1e-11


def test_operations_of_chains_grow_by_the_same_for_every_loop(found: Speed) -> None:
    (growth,) = (growth for growth in found.growths if growth.quantity == "operations")
    assert growth.values[6] - growth.values[5] == pytest.approx((growth.values[5] - growth.values[1]) / 4, rel=0.02)


def test_json_holds_the_figures(found: Speed) -> None:
    text = json_text(found.to_dict())
    read = json.loads(text)
    assert set(read) == {"facts", "missing", "effort", "subjects", "limits", "goals", "lines", "curves", "growths"}
    assert {"machine", "versions", "made"} <= set(read["facts"])
    assert set(read["limits"]) == {"vector", "scalar", "bandwidth", "lanes"}
    assert all({"subject", "work", "tool", "kind"} <= set(line) for line in read["lines"])
    assert read["goals"][0]["reached"] in (True, False) and read["goals"][8]["found"] is None
    assert {point["setting"] for point in read["curves"][0]["points"]} == {"rtol 1e-04", "rtol 1e-08"}


def test_tables_have_as_many_cells_as_heads(found: Speed) -> None:
    made = tables(found)
    assert {table.part for table in made} == {"goals", *SUBJECTS}
    assert all(len(row) == len(table.head) for table in made for row in table.rows)
    assert all(table.head[1] == ">times ours" for table in made if table.part in ("build", "dynamics", "batch"))


def test_the_page_stands_alone(found: Speed) -> None:
    strange = replace(found, missing={"Drake": "no <wheel> for this machine"})
    text = bench_page(strange, None)
    assert not re.findall(r'\b(?:src|href|data)\s*=\s*"(?!#|data:)[^"]*"', text)
    assert text.count("<svg") == 4 and "no &lt;wheel&gt;" in text
    assert all(words in html.unescape(text) for words in ("Goals", "Growth", "N four-bars"))


def test_missing_peers_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(*_: object) -> None:
        raise Missing("not installed; run: python -m pip install it")

    for module in (build, dynamics, lockstep, scaling, swing):
        monkeypatch.setattr(module, "MujocoSoft", absent)
    for module in (build, dynamics, scaling, swing):
        monkeypatch.setattr(module, "pinocchio_direct", absent)
    monkeypatch.setattr(run, "sympy_dynamics", absent)
    small = replace(SMALL, chains=(1,), tolerances=(1e-4,), duration=0.02, thorough=False)
    found = bench_speed(small)
    assert set(found.missing) == {"MuJoCo", "Pinocchio", "SymPy"}
    assert all("pip install" in why for why in found.missing.values())
    assert {curve.kind for curve in found.curves} == {"ours"}
    assert all(line.time is None and line.ratio is None for line in found.lines if line.kind == "peer")
    assert "multipliers" in found.facts["reference of the swing"]
    assert all(len(row) == len(table.head) for table in tables(found) for row in table.rows)


def test_sympy_is_stopped_at_its_patience() -> None:
    found = bench_speed(replace(SMALL, derivation=0.0), ["dynamics"])
    (line,) = (line for line in found.lines if line.tool.startswith("SymPy"))
    assert line.time is None and line.note == "not derived within 0 s"
    assert issubclass(Stopped, Exception) and found.missing == {"SymPy": line.note}


def test_unknown_subjects_are_refused() -> None:
    with pytest.raises(UnknownName, match="did you mean 'batch'"):
        bench_speed(SMALL, ["bach"])


def test_limits_of_the_machine() -> None:
    limit = machine_limit(repeats=2, seconds=1e-4)
    assert limit.lanes in (2, 4, 8) and min(limit.scalar, limit.vector, limit.bandwidth) > 0
    known = Limit(lanes=8, scalar=1e9, vector=8e9, bandwidth=1e10)
    assert known.seconds(800) == pytest.approx(1e-7) and known.seconds(800, wide=False) == pytest.approx(8e-7)
    assert known.seconds(800, 10_000) == pytest.approx(1e-6)


def test_exponents() -> None:
    assert exponent({1: 100.0, 5: 5.0**1.5, 10: 10.0**1.5, 40: 40.0**1.5}) == pytest.approx(1.5)
    assert exponent({1: 1.0, 5: 5.0}) is None
    assert Growth("x", "batch", "ours", {5: 1.0, 10: 2.0}).exponent == pytest.approx(1.0)


def test_goals_are_judged() -> None:
    lines = [
        Line("dynamics", dynamics.FORWARD, "nullbody, native", "ours", Timing(2e-7, 0.0), 1.0, reference=True),
        Line("dynamics", dynamics.FORWARD, "engine", "peer", Timing(2e-6, 0.0), 10.0),
        Line("simulate", lockstep.WORK, "nullbody, RK4, without projection", "ours", Timing(4e-7, 0.0), 1.0),
    ]
    curves = [
        Curve("nullbody.simulate", "ours", (Point("a", Timing(1e-3, 0), 1e-8), Point("b", Timing(6e-3, 0), 1e-9)))
    ]
    growths = [
        Growth("nullbody, native", "forward dynamics", "ours", {5: 1e-7, 40: 8e-7}),
        Growth("nullbody", "derive", "ours", {5: 1.0, 40: 2.5}),
    ]
    judged = [goal.reached for goal in goals(lines, curves, growths)]
    assert judged == [True, False, None, None, None, None, False, True, False, True]
    words = [row[-1] for row in goal_table(goals(lines, curves, growths)).rows]
    assert words[:3] == ["reached", "missed", "not run"]
    assert Goal("x", None, 1.0).reached is None


def test_quick_is_less_than_everything() -> None:
    quick, full = Effort.quick(), Effort.full()
    assert quick.repeats < full.repeats and set(quick.chains) <= set(full.chains)
    assert quick.robots < full.robots and len(quick.timesteps) < len(full.timesteps)
    assert quick.robots < full.robots and not quick.thorough
