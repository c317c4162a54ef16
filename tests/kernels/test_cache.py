from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nullbody.errors import CacheError
from nullbody.kernels import Program, compile_programs, interpret
from nullbody.kernels import compile as compile_module
from nullbody.kernels.cache import cache_folder

GROUPS = np.linspace(0, 1, 5), np.zeros(0), np.array([0.3, -0.7])
posix = pytest.mark.skipif(sys.platform == "win32", reason="owners and modes of files are those of POSIX")


@pytest.fixture
def program(random_program: Callable[..., Program]) -> Program:
    return random_program(7)


def _origin(program: Program) -> str:
    """Where the kernel came from, after checking that it is right."""
    library = compile_programs([program])
    for native, reference in zip(library.kernels["f"](*GROUPS), interpret(program, *GROUPS), strict=True):
        np.testing.assert_allclose(native, reference, rtol=1e-12)
    return library.origin


def test_the_second_time_comes_from_the_cache(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert _origin(program) == "compiled"
    assert [path.suffix for path in cache.iterdir()] == [".o"]
    monkeypatch.setattr(compile_module, "module_ir", None)  # a warm start prints no IR
    assert _origin(program) == "cache"


def test_another_tape_is_another_object(program: Program, cache: Path) -> None:
    _origin(program)
    tape = program.tape
    changed = replace(program, tape=replace(tape, constants=tuple(np.nextafter(c, 9).item() for c in tape.constants)))
    assert _origin(changed) == "compiled"
    flipped = replace(program, tape=replace(tape, outputs=(tape.outputs[0] ^ 1, *tape.outputs[1:])))
    assert _origin(flipped) == "compiled"
    assert len(list(cache.iterdir())) == 3


@pytest.mark.parametrize("damage", ["flip", "truncate", "empty", "text"])
def test_a_damaged_file_is_rebuilt(damage: str, program: Program, cache: Path) -> None:
    _origin(program)
    (path,) = cache.iterdir()
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 16
    path.write_bytes(
        {"flip": bytes(content), "truncate": path.read_bytes()[:-9], "empty": b"", "text": b"hello"}[damage]
    )
    assert _origin(program) == "compiled"
    assert _origin(program) == "cache"


def test_off_means_off(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NULLBODY_CACHE", "off")
    assert [_origin(program), _origin(program)] == ["compiled", "compiled"]
    assert not cache.exists()


def test_a_folder_that_cannot_be_made_is_named(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.write_text("a file, not a folder")
    for folder in (cache, cache / "below"):
        monkeypatch.setenv("NULLBODY_CACHE", str(folder))
        with pytest.raises(CacheError, match="NULLBODY_CACHE=off") as caught:
            compile_programs([program])
        assert str(folder) in str(caught.value)


def test_a_failed_write_leaves_nothing(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(CacheError, match="No space left"):
        compile_programs([program])
    assert list(cache.iterdir()) == []


@posix
def test_the_folder_is_private(program: Program, cache: Path) -> None:
    _origin(program)
    assert cache.stat().st_mode & 0o777 == 0o700
    assert next(cache.iterdir()).stat().st_mode & 0o077 == 0


@posix
@pytest.mark.parametrize("what", ["folder", "file"])
def test_what_others_can_write_is_not_loaded(what: str, program: Program, cache: Path) -> None:
    _origin(program)
    path = cache if what == "folder" else next(cache.iterdir())
    path.chmod(0o777)
    with pytest.raises(CacheError, match=f"chmod go-w {path}"):
        compile_programs([program])
    path.chmod(0o700)
    assert _origin(program) == "cache"


@posix
def test_what_belongs_to_others_is_not_loaded(program: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    _origin(program)
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    with pytest.raises(CacheError, match="belongs to user"):
        compile_programs([program])


def test_two_processes_build_at_the_same_time(cache: Path) -> None:
    code = """
from nullbody.expr import Graph, sin
from nullbody.expr.tape import Tape
from nullbody.kernels import Program, compile_programs
x = Graph().symbol("x")
f = x
for _ in range(200):
    f = sin(f + x) * x - f / 3
program = Program("f", (("x", 1),), (("y", (1,)),), Tape.of([f], ["x"]))
print(compile_programs([program]).kernels["f"]([0.7])[0][0])
"""
    processes = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) for _ in range(3)]
    results = {process.communicate(timeout=100)[0] for process in processes}
    assert len(results) == 1
    assert float(results.pop()) != 0
    assert [path.suffix for path in cache.iterdir()] == [".o"]


def test_the_usual_folder_belongs_to_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("NULLBODY_CACHE")
    for name in ("HOME", "USERPROFILE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))
    folder = cache_folder()
    assert folder is not None
    assert folder.is_relative_to(tmp_path)
    assert "nullbody" in folder.parts
