"""derive, inverse, verify, models and reproduce: what they print is what the library finds."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import nullbody as library
from nullbody import report


@pytest.fixture(scope="module")
def model() -> library.Model:
    return library.build(library.derive(library.catalog.three_prs()))


def test_models_lists_the_catalog(nullbody) -> None:
    found = nullbody("models --json").json
    assert list(found) == list(library.catalog.ENTRIES)
    assert found["three_prs"]["inputs"] == {"F1": "s1", "F2": "s2", "F3": "s3"}
    assert found["three_prs"]["parameters"]["Iyy"]["formula"] == "M*b^2/2"
    shown = nullbody("models").out
    assert all(name in shown for name in library.catalog.MODELS)


def test_models_shows_one_of_them(nullbody) -> None:
    shown = nullbody("models three_prs").out
    assert all(word in shown for word in ("nq = 12", "nv = 3", "leg1 leg2 leg3", "kg m^2", "M*b^2/2"))
    assert "Lee, D. K. Shah" in nullbody("models three_rps").out
    ended = nullbody("models three_rpx --json")
    assert (ended.code, ended.out) == (2, "")
    assert "did you mean 'three_rps'" in ended.err


def test_derive_prints_the_equations(nullbody) -> None:
    equations = library.derive(library.catalog.three_prs())
    assert nullbody("derive three_prs").out == f"{equations}\n"
    assert nullbody("derive three_prs --latex delta").out == f"{equations.latex('delta')}\n"
    assert nullbody("derive three_prs").err.startswith("derived in ")


def test_derive_counts_operations(nullbody) -> None:
    found = nullbody("derive three_prs --independent y,psi,phi --json").json
    equations = library.derive(library.catalog.three_prs(), ("y", "psi", "phi"))
    assert found["outputs"]["N"] == {"shape": [12, 3], "operations": vars(equations.operations("N"))}
    assert found["routines"]["energy"]["operations"] == vars(equations.routine_operations("energy"))
    assert str(equations.operations("N").arithmetic) in nullbody("derive three_prs --independent y,psi,phi --ops").out


def test_derive_writes_the_output_it_was_asked_for(nullbody, tmp_path: Path) -> None:
    ended = nullbody("derive three_prs --latex delta -o delta.tex --json")
    assert ended.json["latex"] in (tmp_path / "delta.tex").read_text(encoding="utf-8")
    assert ended.json["file"] == "delta.tex"


def test_inverse_along_the_reference(nullbody, model: library.Model) -> None:
    found = nullbody("inverse three_prs --until 1 --samples 3 --json").json
    desired = library.control.desired_motion(model, library.control.paper_reference(), 1.0)
    assert found["t"] == [0.0, 0.5, 1.0]
    expected = np.transpose([desired.inputs(t) for t in found["t"]])
    np.testing.assert_allclose([found["F1"], found["F2"], found["F3"]], expected, atol=1e-12)
    assert "F1 [N]" in nullbody("inverse three_prs --samples 3").out


def test_inverse_in_one_state(nullbody, model: library.Model) -> None:
    line = "inverse three_prs --at s1=0.6,s2=0.5,s3=0.6 --rates s1=0.1 --accelerations s2=-0.5"
    found = nullbody(f"{line} --json").json
    state = library.assemble(model, {"s1": 0.6, "s2": 0.5, "s3": 0.6}, v=[0.1, 0, 0])
    u = model.inverse_dynamics(state, [0, -0.5, 0])
    assert list(found["inputs"].values()) == u.tolist()
    assert list(found["reactions"].values()) == model.reactions(state, u).tolist()
    assert "leg3 z" in nullbody(line).out


def test_inverse_kinematics(nullbody, model: library.Model) -> None:
    found = nullbody("inverse three_prs --pose y=0.45,psi=0.05,phi=0 --json").json
    state = library.inverse_kinematics(model, {"y": 0.45, "psi": 0.05, "phi": 0})
    assert found["coordinates"] == dict(state.positions)
    assert found["singularity"]["forward"] == library.singularity(model, state).forward
    assert "subspace_error" in nullbody("inverse three_prs --pose y=0.45,psi=0.05,phi=0").out


def test_guess_chooses_the_branch(nullbody) -> None:
    hanging = "--guess y=-0.5,alpha1=-1.57,alpha2=-1.57,alpha3=-1.57"
    found = nullbody(f"inverse three_prs --at s1=0.6,s2=0.6,s3=0.6 {hanging} --json").json
    assert found["coordinates"]["y"] == pytest.approx(-0.5)


def test_verify_agrees(nullbody) -> None:
    found = nullbody("verify three_prs --engines multipliers --states 5 --set ms=0.2 --json").json
    assert found["ok"]
    assert found["parameters"]["ms"] == 0.2
    assert found["engines"]["multipliers"]["forward_dynamics"]["max_rel_error"] < 1e-12


def test_verify_that_fails_exits_with_1(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    compare = library.verify.compare
    monkeypatch.setattr(library.verify, "compare", lambda *a, **options: compare(*a, tolerance=1e-30, **options))
    ended = nullbody("verify three_prs --engines multipliers --states 2 --json")
    assert (ended.code, ended.json["ok"]) == (1, False)
    assert ended.err.startswith("error: multipliers")
    assert ended.err.count("\n") == 1


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The folders that the report is asked to write; the report itself takes a minute and has its own tests."""
    folders: list[Path] = []

    def fake(out: Path) -> dict[str, object]:
        folders.append(out)
        ratio = {"symbolic_ratio_vs_gauss_jordan": 300.04, "symbolic_ratio_vs_gauss_jordan_is_lower_bound": True}
        return {"checks": {"agrees": 9, "differs": 2}, "nullspace": ratio, "appendix": {"exact": float("nan")}}

    monkeypatch.setattr(report, "reproduce", fake)
    return folders


def test_reproduce_hands_over_folder_and_summary(nullbody, asked: list[Path]) -> None:
    ended = nullbody("reproduce --out here --json")
    assert ended.json["checks"] == {"agrees": 9, "differs": 2}
    assert ended.json["appendix"] == {"exact": None}
    assert asked == [Path("here")]


def test_reproduce_names_the_page_and_the_verdicts(nullbody, asked: list[Path]) -> None:
    ended = nullbody("reproduce")
    assert asked == [Path("out/reproduce")]
    assert ended.out.splitlines()[-1] == str(Path("out/reproduce/index.html"))
    assert re.search(r"checks that agree +9\b", ended.out)
    assert re.search(r"faster than Gauss-Jordan +at least 300\b", ended.out)
    assert "computed torque" not in ended.out  # not in this summary
    assert ended.err.startswith("2 of the checks differ")


def test_reproduce_takes_a_folder_that_cannot_be_written_as_bad_input(nullbody, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    ended = nullbody("reproduce --out file")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("error: ")
