"""Commands take model files where they take names of the catalog."""

from __future__ import annotations

from pathlib import Path

import pytest

from nullbody.catalog import four_bar
from nullbody.formats import write_mjcf, write_yaml

URDF = """<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.02" izz="0.02"/></inertial></link><joint name="q" type="continuous"><parent link="base"/>
<child link="arm"/><axis xyz="0 1 0"/></joint></robot>"""


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a four-bar in two formats and a pendulum in the third; the current one."""
    (tmp_path / "bar.yaml").write_text(write_yaml(four_bar()), encoding="utf-8")
    (tmp_path / "bar.xml").write_text(write_mjcf(four_bar()), encoding="utf-8")
    (tmp_path / "arm.URDF").write_text(URDF, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", ["bar.yaml", "bar.xml", "arm.URDF"])
def test_derive_takes_a_file(nullbody, files: Path, name: str) -> None:
    ended = nullbody(f"derive {files / name} --json")
    assert ended.code == 0, ended.err
    assert len(ended.json["independent"]) == 1


def test_simulate_and_inverse_take_a_file(nullbody, files: Path) -> None:
    ended = nullbody("simulate bar.yaml --until 0.1 --forces torque=0.2 --json")
    assert ended.code == 0, ended.err
    assert ended.json["outcome"] == "COMPLETED"
    ended = nullbody("inverse bar.yaml --at theta1=1 --json")
    assert ended.code == 0, ended.err


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.yaml", "error: none.yaml: there is no such file"),
        ("bad.yaml", "error: bad.yaml, line 1: a model file is a mapping"),
        ("bad.urdf", "error: bad.urdf, line 1: this is no XML"),
        ("bar.json", "error: there is no model in the catalog 'bar.json'"),
    ],
)
def test_a_file_that_cannot_be_read_is_bad_input(nullbody, files: Path, name: str, message: str) -> None:
    for bad in ("bad.yaml", "bad.urdf"):
        (files / bad).write_text("- 1\n", encoding="utf-8")
    ended = nullbody(f"derive {name}")
    assert ended.code == 2
    assert ended.err.startswith(message)
    assert len(ended.err.splitlines()) == 1
