"""Models from the cache: the same as derived ones, found by what the mechanism says and by nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import nullbody.model.blueprint as module
from nullbody import build, derive
from nullbody.catalog import MODELS, n_four_bar, three_prs
from nullbody.errors import InputError, UnknownName
from nullbody.mechanism import Body, Friction, fingerprint
from nullbody.model.blueprint import Blueprint


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache of this test."""
    monkeypatch.setenv("NULLBODY_CACHE", str(tmp_path))
    return tmp_path


@pytest.fixture
def derivations(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the mechanisms that are derived meanwhile."""
    seen: list[str] = []

    def counted(mechanism, *arguments, **options):
        seen.append(mechanism.name)
        return derive(mechanism, *arguments, **options)

    monkeypatch.setattr(module, "derive", counted)
    return seen


@pytest.mark.parametrize("name", ["four_bar", "three_prs", "rolling_disc", "rssr"])
def test_a_blueprint_read_back_is_the_same(name: str) -> None:
    made = Blueprint.of(derive(MODELS[name]()))
    assert Blueprint.read(made.body) == made


def test_the_second_model_is_not_derived(derivations: list[str]) -> None:
    first, second = build(three_prs()), build(three_prs())
    assert derivations == ["three_prs"]
    assert second.library.origin == "cache"
    assert second.mobility == first.mobility
    q, v, u = np.linspace(0.1, 1.2, 12), np.array([0.1, 0.2, 0.3]), np.ones(3)
    for one, two in zip(
        first.evaluate("forward_dynamics", q, v, u), second.evaluate("forward_dynamics", q, v, u), strict=True
    ):
        np.testing.assert_array_equal(one, two)


def test_what_is_asked_for_is_part_of_the_key(derivations: list[str]) -> None:
    mechanism = three_prs()
    assert build(mechanism).independent == ("s1", "s2", "s3")
    assert build(mechanism, independent=["y", "psi", "theta"]).independent == ("y", "psi", "theta")
    assert build(mechanism, basis=("s1", "s2", "s3")).basis == ("s1", "s2", "s3")
    build(mechanism, {"l": 0.6}, independent=("y", "psi", "theta"))
    assert len(derivations) == 3


def test_an_edit_of_the_package_makes_entries_useless(derivations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    build(n_four_bar())
    monkeypatch.setattr(module, "_sources", lambda: "another version")
    build(n_four_bar())
    assert len(derivations) == 2


def test_an_edit_that_keeps_size_and_time_is_seen(tmp_path: Path) -> None:
    file = tmp_path / "module.py"
    file.write_text("EPS = 1e-9")
    os.utime(file, (0, 0))
    before = module._stamp(file)
    while file.stat().st_ctime_ns == int(before.split()[-1]):  # the clock of the file system has ticks
        file.write_text("EPS = 1e-8")
        os.utime(file, (0, 0))
    assert file.stat().st_size == 10
    assert module._stamp(file) != before


def test_the_tolerances_are_among_the_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    monkeypatch.setattr(module, "_stamp", lambda path: seen.append(path.name) or path.name)
    module._sources.__wrapped__()
    assert {"tolerances.py", "derive.py", "blueprint.py"} <= set(seen)


def test_sources_are_those_of_the_import() -> None:
    program = "import nullbody.model.blueprint as b; print(b._sources.cache_info().currsize)"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout == "1\n"


def test_names_of_another_type_come_back_as_names() -> None:
    chosen = [np.str_("y"), np.str_("psi"), np.str_("theta")]
    for _ in range(2):
        assert build(three_prs(), independent=chosen).independent == ("y", "psi", "theta")


def test_an_entry_of_another_key_is_not_read(derivations: list[str], folder: Path) -> None:
    build(n_four_bar())
    build(three_prs())
    files = sorted(folder.iterdir())
    content = [file.read_bytes() for file in files]
    for file, other in zip(files, (*content[1:], content[0]), strict=True):
        file.write_bytes(other)
    assert build(n_four_bar()).independent == ("theta0",)
    assert build(three_prs()).independent == ("s1", "s2", "s3")
    assert len(derivations) == 4


def test_without_a_cache_everything_is_derived(derivations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NULLBODY_CACHE", "off")
    build(n_four_bar())
    build(n_four_bar())
    assert len(derivations) == 2


def test_a_damaged_entry_is_derived_anew(derivations: list[str], folder: Path) -> None:
    build(n_four_bar())
    for file in folder.iterdir():
        body = bytearray(file.read_bytes())
        body[-5] ^= 1
        file.write_bytes(body)
    assert build(n_four_bar()).independent == ("theta0",)
    assert len(derivations) == 2


def test_fingerprints_tell_mechanisms_apart() -> None:
    plain = three_prs()
    others = [
        three_prs(l=0.6),
        replace(plain, name="another"),
        replace(plain, gravity=(0, 0, 0)),
        replace(plain, bodies=(*plain.bodies[:-1], Body("slider3", 1.0))),
        replace(plain, loads=(Friction("rub", "s1", "1"),)),
        replace(plain, home={**plain.home, "y": "l/2"}),
        n_four_bar(2),
        n_four_bar(3),
    ]
    prints = [fingerprint(mechanism) for mechanism in (plain, *others)]
    assert len(set(prints)) == len(prints)
    assert fingerprint(three_prs()) == fingerprint(plain)


@dataclass(frozen=True)
class Gale(Friction):
    """A load of somebody else's: what it does is not in its fields."""


def test_a_part_of_your_own_is_never_kept(derivations: list[str]) -> None:
    mechanism = replace(three_prs(), loads=(Gale("gale", "s1", "1"),))
    assert fingerprint(mechanism) is None
    build(mechanism)
    build(mechanism)
    assert len(derivations) == 2


def test_bad_arguments_are_refused_as_derive_does() -> None:
    with pytest.raises(InputError, match="independent must be a list of coordinate names, not 3"):
        build(three_prs(), independent=3)  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="no coordinate 's4'"):
        build(three_prs(), independent=("s1", "s2", "s4"))
    with pytest.raises(InputError, match="are chosen in derive"):
        build(derive(three_prs()), independent=("s1", "s2", "s3"))
    with pytest.raises(InputError, match="build takes Equations from derive\\(mechanism\\), or a Mechanism, not str"):
        build("three_prs")  # type: ignore[arg-type]
