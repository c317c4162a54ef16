"""What is in a unit: descriptions that FMPy accepts, sources without a warning, the same bytes again."""

from __future__ import annotations

import math
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

import nullbody
from nullbody.export import write_fmu
from nullbody.export.fmu.binary import PLATFORMS, compiler, folder, here
from nullbody.export.fmu.units import base_units, display_unit, times
from tests.export.mock_up import CASES, flat, start_of

fmpy = pytest.importorskip("fmpy", reason="needs the extra fmu")
validate_fmu = pytest.importorskip("fmpy.validation", reason="needs the extra fmu").validate_fmu


def text_of(path: Path, member: str) -> str:
    with zipfile.ZipFile(path) as archive:
        return archive.read(member).decode()


def written(mechanism: nullbody.Mechanism, path: Path, **options) -> Path:
    write_fmu(nullbody.derive(mechanism), path, **({"platforms": []} | options))
    return path


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", CASES)
def test_fmpy_finds_nothing_wrong(tmp_path: Path, name: str, fmi: int) -> None:
    path = written(CASES[name][0](), tmp_path / "unit.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("label", "name", "convention"),
    [
        ("left", "reaction.left.drive", "structured"),
        ("left arm", "reaction.'left arm drive'", "structured"),
        ("left.arm (1)", "reaction.'left.arm (1) drive'", "structured"),
        ('it\'s "left"', 'reaction.it\'s "left" drive', "flat"),
        ("links Ü\tß <&>", "reaction.links Ü ß <&> drive", "flat"),
    ],
)
def test_names_with_spaces_and_signs(tmp_path: Path, label: str, name: str, convention: str, fmi: int) -> None:
    path = written(flat(label), tmp_path / "unit.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    assert description.variableNamingConvention == convention
    assert name in {v.name for v in description.modelVariables}


@pytest.mark.parametrize(("name", "identifier"), [("arm 2.0", "arm_2_0"), ("3-PRS", "model_3_PRS"), ("Ü", "model__")])
def test_any_name_of_a_mechanism_will_do(tmp_path: Path, name: str, identifier: str) -> None:
    b = nullbody.MechanismBuilder(name)
    b.point_mass("cart", 1.0)
    b.prismatic("x", "ground", "cart", axis="x")
    b.actuator("push", "x")
    path = tmp_path / "unit.fmu"
    write_fmu(nullbody.derive(b.build()), path)
    description = fmpy.read_model_description(str(path))
    assert (description.modelName, description.coSimulation.modelIdentifier) == (name, identifier)
    ran = fmpy.simulate_fmu(str(path), stop_time=1.0, start_values={"push": 2.0}, output=["x"])
    assert ran["x"][-1] == pytest.approx(1.0, rel=1e-9)


def test_signs_that_xml_cannot_hold_are_replaced(tmp_path: Path) -> None:
    path = written(flat("push\x01 \uffff"), tmp_path / "unit.fmu", fmi=2)
    names = {v.name for v in fmpy.read_model_description(str(path)).modelVariables}
    assert any("push_ _" in name for name in names)


def test_states_and_derivatives_are_declared(tmp_path: Path) -> None:
    equations, _, state = start_of("three_prs")
    write_fmu(equations, tmp_path / "unit.fmu", start=state, platforms=[])
    description = fmpy.read_model_description(str(tmp_path / "unit.fmu"))
    rates = [f"{name}_dot" for name in equations.independent]
    states = [unknown.variable.derivative.name for unknown in description.derivatives]
    assert states == [*equations.coordinates, *rates]
    assert [u.variable.name for u in description.derivatives][-3:] == [f"{n}_ddot" for n in equations.independent]
    known = {v.name: v for v in description.modelVariables}
    assert [float(known[name].start) for name in equations.coordinates] == state.q.tolist()
    assert [float(known[name].start) for name in rates] == state.v.tolist()
    assert {name for name, v in known.items() if v.causality == "input"} == set(equations.inputs)
    outputs = {u.variable.name: u.dependencies for u in description.outputs}
    assert [v.name for v in outputs["y"]] == ["y"]  # no force acts on a position at once
    assert outputs["y_ddot"] is None  # on an acceleration it does


def test_units_are_in_base_units_and_angles_in_degrees(tmp_path: Path) -> None:
    root = ElementTree.fromstring(text_of(written(CASES["four_bar"][0](), tmp_path / "u.fmu"), "modelDescription.xml"))
    units = {unit.get("name"): unit for unit in root.iter("Unit")}
    assert units["N m"].find("BaseUnit").attrib == {"kg": "1", "m": "2", "s": "-2"}
    shown = units["rad/s^2"].find("DisplayUnit")
    assert shown.get("name") == "deg/s^2"
    assert float(shown.get("factor")) * math.pi == pytest.approx(180)
    angles = [real for real in root.iter("Real") if real.get("unit") == "rad"]
    assert angles
    assert {real.get("displayUnit") for real in angles} == {"deg"}


@pytest.mark.parametrize(
    ("text", "exponents"),
    [
        ("kg m^2", {"kg": 1, "m": 2}),
        ("N s/m", {"kg": 1, "s": -1}),
        ("N m s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("1/s", {"s": -1}),
        ("kg/m^3", {"kg": 1, "m": -3}),
        ("m/m", {}),
        ("", {}),
        ("furlong", None),
        ("kg?", None),
    ],
)
def test_units_are_read(text: str, exponents: dict[str, int] | None) -> None:
    assert base_units(text) == exponents


def test_units_of_rates() -> None:
    assert (times("m", "/s"), times("", "/s")) == ("m/s", "1/s")
    assert display_unit("m") is None


def test_parameters_that_follow_are_calculated_unless_given(tmp_path: Path) -> None:
    equations = nullbody.derive(nullbody.catalog.three_prs())
    kinds = {}
    for key, model in (("free", nullbody.build(equations)), ("given", nullbody.build(equations, {"Iyy": 0.015}))):
        write_fmu(model, tmp_path / "u.fmu", platforms=[])
        known = {v.name: v for v in fmpy.read_model_description(str(tmp_path / "u.fmu")).modelVariables}
        kinds[key] = (known["Iyy"].causality, known["Iyy"].start)
    assert kinds == {"free": ("calculatedParameter", None), "given": ("parameter", "0.015")}


def test_without_reactions_there_are_fewer_outputs(tmp_path: Path) -> None:
    path = written(CASES["four_bar"][0](), tmp_path / "u.fmu", reactions=False, platforms=None)
    description = fmpy.read_model_description(str(path))
    assert not [v.name for v in description.modelVariables if v.name.startswith("reaction")]
    assert validate_fmu(str(path)) == []
    assert len(fmpy.simulate_fmu(str(path), stop_time=0.01)) > 1


def test_the_same_model_gives_the_same_bytes(tmp_path: Path) -> None:
    equations = nullbody.derive(CASES["four_bar"][0]())
    for name in ("a", "b"):
        write_fmu(equations, tmp_path / f"{name}.fmu")
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


def test_the_page_tells_names_in_order_and_what_is_refused(tmp_path: Path) -> None:
    page = text_of(written(flat("<b>&"), tmp_path / "u.fmu"), "documentation/index.html")
    assert "<b>&" not in page
    assert "&lt;b&gt;&amp;" in page
    assert page.index("rail, swing, swing_dot") > 0
    assert "SINGULAR_INDEPENDENT_SET" in page


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["three_prs", "shaken", "chaplygin_sleigh"])
def test_sources_compile_without_a_warning_or_a_global(tmp_path: Path, name: str, fmi: int) -> None:
    gcc, nm = shutil.which("gcc"), shutil.which("nm")
    if not (gcc and nm):
        pytest.skip("needs gcc and nm")
    with zipfile.ZipFile(written(CASES[name][0](), tmp_path / "u.fmu", fmi=fmi)) as archive:
        archive.extractall(tmp_path)
    files = [f"fmi{fmi}.c", "kernels.c"]
    command = [gcc, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-fno-pic", "-O0", "-c", *files]
    done = subprocess.run(command, cwd=tmp_path / "sources", capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    listed = subprocess.run([nm, f"fmi{fmi}.o", "kernels.o"], cwd=tmp_path / "sources", capture_output=True, text=True)
    symbols = [line.split()[-2:] for line in listed.stdout.splitlines() if len(line.split()) >= 2]
    assert not [name for kind, name in symbols if kind in "bBdDcC"]  # no variable outlives a call
    needed = {name for kind, name in symbols if kind == "U"} - {name for kind, name in symbols if kind == "T"}
    allowed = {"calloc", "free", "memcpy", "memset", "strcmp", "snprintf", "sqrt", "sin", "cos", "pow", "fmax", "fmin"}
    assert needed <= allowed | {"__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_", "fabs", "sincos"}


def test_platforms_have_the_folders_of_their_version() -> None:
    assert folder("win64", 2) == "binaries/win64"
    assert folder("win64", 3) == "binaries/x86_64-windows"
    assert here() in {*PLATFORMS, None}


def test_zig_compiles_for_other_platforms() -> None:
    pytest.importorskip("ziglang", reason="needs the package ziglang")
    other = "win64" if here() != "win64" else "linux64"
    command = compiler(other)
    assert command is not None
    assert command[1:] == ["-m", "ziglang", "cc", "-target", PLATFORMS[other][1]]
