"""nullbody export fmu: what it says, what it writes, and what it refuses."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from nullbody.export.fmu import binary


def starts(path: str) -> dict[str, float]:
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    reals = ((v.get("name"), v.find("Real") if v.find("Real") is not None else v) for v in root.find("ModelVariables"))
    return {name: float(real.get("start")) for name, real in reals if real.get("start") is not None}


def test_options_reach_the_unit(nullbody) -> None:
    line = "export fmu three_prs --sources-only --set l=0.55,Iyy=0.015 --start s1=0.55,s2=0.6 --rates s3=-0.2 --fmi 3"
    ended = nullbody(f"{line} --guess y=-0.5,alpha1=-1.5,alpha2=-1.5,alpha3=-1.5 --no-reactions -o robot.fmu --json")
    assert ended.code == 0, ended.err
    assert ended.json["file"] == "robot.fmu"
    assert (ended.json["fmi"], ended.json["platforms"], ended.json["states"]) == (3, [], 15)
    found = starts("robot.fmu")
    assert (found["l"], found["Iyy"], found["s3_dot"], found["s1"]) == (0.55, 0.015, -0.2, 0.55)
    assert found["y"] < -0.4
    with zipfile.ZipFile("robot.fmu") as archive:
        assert b"reaction." not in archive.read("modelDescription.xml")


def test_charts_of_co_simulation(nullbody) -> None:
    ended = nullbody("export fmu five_bar --chart phi,theta1 --chart theta2,gamma --sources-only -o u.fmu")
    assert ended.code == 0, ended.err
    with zipfile.ZipFile("u.fmu") as archive:
        assert b"<p>theta1, theta2; phi, theta1; theta2, gamma</p>" in archive.read("documentation/index.html")


def test_the_file_has_the_name_of_the_mechanism(nullbody) -> None:
    ended = nullbody("export fmu a01_pendulum --independent y")
    assert ended.code == 0, ended.err
    assert ended.out.startswith("a01_pendulum.fmu: FMI 2.0, 3 states, C sources, ")
    assert "y_dot" in starts("a01_pendulum.fmu")


def test_without_a_compiler_a_note_says_so(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(binary.shutil, "which", lambda name: None)
    monkeypatch.setattr(binary, "find_spec", lambda name: None)
    ended = nullbody("export fmu a01_pendulum --independent y -o p.fmu")
    assert ended.code == 0
    assert "no binaries" in ended.out
    assert ended.err.startswith("no C compiler was found")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("a01_pendulum --fmi 1", "fmi must be 2 or 3, not 1"),
        ("a01_pendulum -o unit.zip", "its name must end in .fmu"),
        ("a01_pendulum --platforms linux", "there is no platform 'linux'; did you mean 'linux64'?"),
        ("a01_pendulum --platforms linux64 --sources-only", "exclude each other"),
        ("a01_pendulum --rates z=1", "there is no independent rate 'z'"),
        ("nothing", "there is no model in the catalog 'nothing'"),
    ],
)
def test_bad_input_is_refused(nullbody, line: str, message: str) -> None:
    ended = nullbody(f"export fmu {line}")
    assert (ended.code, ended.out) == (2, "")
    assert message in ended.err
    assert not list(Path().iterdir())
