"""Bad input: exit code 2, one line on stderr that says what to do, nothing on stdout, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest

from nullbody.errors import VerificationError

WRONG = [
    ("derive", "Missing argument 'MECHANISM'. See nullbody derive --help"),
    ("deriv three_prs", "No such command 'deriv'"),
    ("derive three_prs --opps", "No such option: --opps"),
    ("derive three_pr", "did you mean 'three_prs'?"),
    ("derive three_prs --latex N_scald", "did you mean 'N_scaled'?"),
    ("derive three_prs --independent s1,s2,s4", "no coordinate 's4'; did you mean"),
    ("derive three_prs --independent s1,s2", "name 3 coordinates"),
    ("derive three_prs -o equations.pdf", "must end in .tex"),
    ("simulate three_prs --set l=-1", "parameter l (length of the links) must be positive, not -1 m"),
    ("simulate three_prs --set l=0", "must be positive"),
    ("simulate three_prs --set l=nan", "must be finite"),
    ("simulate three_prs --set l=long", "--set l must be a number, not 'long'"),
    ("simulate three_prs --set l=__import__('os')", "must be a number"),
    ("simulate three_prs --set l", "--set takes name=value"),
    ("simulate three_prs --set l=0.5,l=0.6", "gives l twice"),
    ("simulate three_prs --set self=1", "there is no parameter 'self'"),
    ("simulate three_prs --start alpha4=1", "did you mean 'alpha"),
    ("simulate three_prs --start s1=-9,s2=0.6,s3=0.6", "loop 'leg1' stays open by"),
    ("simulate three_prs --rates F1=1", "no independent rate 'F1'"),
    ("simulate three_prs --forces F9=1", "no input 'F9'"),
    ("simulate three_prs --until -1", "must be finite and after the start"),
    ("simulate three_prs --until soon", "Invalid value for '--until'"),
    ("simulate three_prs --until nan --control feed-forward", "--until must be a positive number"),
    ("simulate three_prs --control pid", "Invalid value for '--control'"),
    ("simulate three_prs --control computed-torque --forces F1=1", "--forces are for --control none"),
    ("simulate three_prs --control computed-torque --gains ki=1", "no gain 'ki'; did you mean 'kp'?"),
    ("simulate three_prs --gains kp=1", "--gains are for"),
    ("simulate three_prs --control computed-torque --reference s9=1", "did you mean 's"),
    ("simulate three_prs --control computed-torque --independent y,psi,phi", "use --independent s1,s2,s3"),
    ("simulate three_prs --rtol 1", "rtol = 1.0 must be within"),
    ("simulate three_prs -o missing/run.nc", "the folder missing does not exist. Make it first"),
    ("simulate three_prs -o run.txt", "must end in .nc or .csv"),
    ("inverse three_prs --pose y=3,psi=0,phi=0", "out of reach"),
    (
        "inverse three_prs --pose y=0.4",
        "a pose of 'three_prs' is 3 of its coordinates, usually of the end effector, not 1",
    ),
    ("inverse three_prs --pose y=0.4 --at s1=0.6", "not both"),
    ("inverse three_prs --rates s1=1", "give it with --at"),
    ("inverse three_prs --until 0", "--until must be a positive number"),
    ("verify three_prs --engines mujocco", "did you mean 'mujoco'?"),
    ("verify three_prs --states 0", "Invalid value for '--states'"),
]


@pytest.mark.parametrize(("line", "why"), WRONG, ids=[line for line, _ in WRONG])
def test_bad_input(nullbody, tmp_path: Path, line: str, why: str) -> None:
    ended = nullbody(line)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("error: ")
    assert ended.err.count("\n") == 1
    assert why in ended.err
    assert list(tmp_path.iterdir()) == []


def test_cache_that_cannot_be_used(nullbody, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NULLBODY_CACHE", str(tmp_path / "file"))
    ended = nullbody("inverse three_prs")
    assert (ended.code, ended.out) == (2, "")
    assert "set NULLBODY_CACHE to a folder that you can write" in ended.err


def test_interrupt(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*arguments: object, **options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("nullbody.verify.compare", interrupted)
    ended = nullbody("verify three_prs")
    assert (ended.code, ended.out, ended.err) == (130, "", "interrupted\n")


def test_missing_engine(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*arguments: object, **options: object) -> None:
        raise VerificationError("mujoco is not installed. Install the extra verify")

    monkeypatch.setattr("nullbody.verify.compare", missing)
    ended = nullbody("verify three_prs")
    assert (ended.code, ended.out, ended.err) == (2, "", "error: mujoco is not installed. Install the extra verify\n")


def test_a_bug_is_not_hidden(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*arguments: object, **options: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("nullbody.verify.compare", broken)
    with pytest.raises(ZeroDivisionError):
        nullbody("verify three_prs")
