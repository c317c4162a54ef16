"""bench: tables on the terminal, figures in files, and what it refuses before it measures anything."""

from __future__ import annotations

import json
from pathlib import Path

from nullbody.bench.settings import PARTS, Settings

LINE = "bench nullspace --quick --limit 0 --only symbolic"


def test_bench_prints_tables_and_facts(nullbody) -> None:
    ended = nullbody(LINE)
    assert ended.code == 0, ended.err
    assert all(words in ended.out for words in ("times ours", "3-PRS generic", "nullbody: N~", "no time was given"))
    assert "machine: " in ended.err


def test_bench_writes_files_and_makes_their_folder(nullbody, tmp_path: Path) -> None:
    ended = nullbody(f"{LINE} --json out/bench.json --html out/bench.html")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "bench.json").read_text(encoding="utf-8"))
    assert {row["part"] for row in found["rows"]} == {"symbolic"}
    assert "operations for N, 3-PRS generic" in (tmp_path / "out" / "bench.html").read_text(encoding="utf-8")
    assert "written: out/bench.json" in ended.err


def test_help_shows_the_default_limits(nullbody) -> None:
    text = " ".join(nullbody("bench --help").out.split())
    assert f"({Settings.full().limit:g}; quick: {Settings.quick().limit:g})" in text
    assert all(part in text for part in PARTS)


def test_bench_prints_json_alone(nullbody) -> None:
    found = nullbody(f"{LINE} --json -").json
    assert found["rows"][0]["reference"] is True and found["rows"][0]["operations"] > 100


def test_bench_refuses_at_once(nullbody, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    for line, words in (
        ("bench nullspce", "did you mean 'nullspace'"),
        ("bench nullspace --only symbols", "there is no part of the benchmark 'symbols'"),
        ("bench nullspace --limit -1", "time limit"),
        ("bench nullspace --json file/bench.json", "is a file, not a folder"),
    ):
        ended = nullbody(line)
        assert ended.code == 2 and words in ended.err, ended
