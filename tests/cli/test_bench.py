"""bench: tables on the terminal, figures in files, and what it refuses before it measures anything."""

from __future__ import annotations

import json
from pathlib import Path

from nullbody.bench.settings import PARTS, Settings
from nullbody.bench.speed import SUBJECTS
from nullbody.cli.bench import _subjects

LINE = "bench nullspace --quick --limit 0 --only symbolic"


def test_bench_prints_tables_and_facts(nullbody) -> None:
    ended = nullbody(LINE)
    assert ended.code == 0, ended.err
    assert all(words in ended.out for words in ("times ours", "3-PRS generic", "nullbody: N~", "no time was given"))
    assert "machine: " in ended.err


def test_bench_writes_files_and_makes_their_folder(nullbody, tmp_path: Path) -> None:
    """Speed and null space in one page and one file."""
    ended = nullbody(f"{LINE} batch --json out/bench.json --html out/bench.html")
    assert ended.code == 0, ended.err
    assert "forward dynamics, many states" in ended.out and "3-PRS generic" in ended.out
    found = json.loads((tmp_path / "out" / "bench.json").read_text(encoding="utf-8"))
    assert found["speed"]["subjects"] == ["batch"]
    assert {row["part"] for row in found["nullspace"]["rows"]} == {"symbolic"}
    page = (tmp_path / "out" / "bench.html").read_text(encoding="utf-8")
    assert all(words in page for words in ("operations for N, 3-PRS generic", "Many states at once", "<svg"))
    assert "written: out/bench.json" in ended.err


def test_help_shows_the_default_limits(nullbody) -> None:
    text = " ".join(nullbody("bench --help").out.split())
    assert f"({Settings.full().limit:g}; quick: {Settings.quick().limit:g})" in text
    assert all(part in text for part in (*PARTS, *SUBJECTS))


def test_subjects_come_in_their_order_and_all_by_default() -> None:
    known = (*SUBJECTS, "nullspace")
    assert _subjects(None) == _subjects(["all"]) == _subjects(["dynamics", "all"]) == known
    assert _subjects(["nullspace", "build", "build"]) == ("build", "nullspace")


def test_bench_prints_json_alone(nullbody) -> None:
    found = nullbody(f"{LINE} --json -").json
    row = found["nullspace"]["rows"][0]
    assert row["reference"] is True and row["operations"] > 100


def test_bench_refuses_at_once(nullbody, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    for line, words in (
        ("bench nullspce", "did you mean 'nullspace'"),
        ("bench build dynamic", "did you mean 'dynamics'"),
        ("bench build --only symbolic", "belong to nullspace, which is not among build"),
        ("bench nullspace --only symbols", "there is no part of the benchmark 'symbols'"),
        ("bench nullspace --limit -1", "time limit"),
        ("bench nullspace --json file/bench.json", "is a file, not a folder"),
    ):
        ended = nullbody(line)
        assert ended.code == 2 and words in ended.err, ended
