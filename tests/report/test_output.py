"""Files appear whole or not at all, and a bad folder is refused before anything is computed."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from nullbody.errors import OutputError
from nullbody.report import Section, reproduce, robot_picture
from nullbody.report.output import usable_folder, write_texts

module = importlib.import_module("nullbody.report.reproduce")


@pytest.mark.parametrize("below", ["", "deeper", "deeper/still"])
def test_a_file_instead_of_a_folder_is_refused_before_computing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, below: str
) -> None:
    monkeypatch.setattr(module, "sections", lambda *_: pytest.fail("it computed first"))
    file = tmp_path / "taken"
    file.write_text("mine")
    with pytest.raises(OutputError, match="taken is a file, not a folder; give another folder"):
        reproduce(file / below)
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]
    assert file.read_text() == "mine"


def test_reproduce_writes_both_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: list[Section]) -> None:
    monkeypatch.setattr(module, "sections", lambda settings, step: made)
    found = reproduce(tmp_path / "new" / "out", progress=False)
    assert sorted(path.name for path in (tmp_path / "new" / "out").iterdir()) == ["index.html", "summary.json"]
    assert found["appendix"] == {"exact": True}
    assert found["checks"]["agrees"] > 15
    assert set(found["machine"]) == {"processor", "cores", "system"}


def test_a_failed_computation_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> list[Section]:
        raise RuntimeError("planted")

    monkeypatch.setattr(module, "sections", failing)
    with pytest.raises(RuntimeError, match="planted"):
        reproduce(tmp_path, progress=False)
    assert list(tmp_path.iterdir()) == []


def test_nothing_half_written_when_the_second_file_fails(tmp_path: Path) -> None:
    (tmp_path / "summary.json").mkdir()
    (tmp_path / "index.html").write_text("old")
    with pytest.raises(OutputError, match=r"summary\.json cannot be written"):
        write_texts(tmp_path, {"index.html": "new", "summary.json": "{}"})
    assert (tmp_path / "index.html").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.html", "summary.json"]


def test_usable_folder_is_made_and_left_empty(tmp_path: Path) -> None:
    folder = usable_folder(tmp_path / "a" / "b")
    assert folder.is_dir() and list(folder.iterdir()) == []


@pytest.mark.parametrize(("name", "start"), [("robot.png", b"\x89PNG"), ("robot.svg", b"<?xml")])
def test_robot_picture_is_a_picture(tmp_path: Path, name: str, start: bytes) -> None:
    written = robot_picture(tmp_path / name)
    assert written.read_bytes().startswith(start)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_robot_picture_names_a_missing_folder(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"robot\.png cannot be written"):
        robot_picture(tmp_path / "missing" / "robot.png")
