from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nullbody.errors import CacheError
from nullbody.kernels import Program, compile_programs, interpret
from nullbody.kernels import cache as cache_module
from nullbody.kernels import compile as compile_module
from nullbody.kernels.cache import cache_folder, cache_info, clear_cache, load, store
from nullbody.kernels.cache_files import size_bound

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


def test_an_object_under_another_key_is_not_loaded(program: Program, random_program, cache: Path) -> None:
    _origin(program)
    (path,) = cache.iterdir()
    other = random_program(8)
    _origin(other)
    (second,) = set(cache.iterdir()) - {path}
    path.write_bytes(second.read_bytes())
    assert _origin(program) == "compiled"
    assert _origin(other) == "cache"


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


def test_a_failed_write_is_a_warning_and_leaves_nothing(
    program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch, pytest.warns(RuntimeWarning, match=r"No space left.*NULLBODY_CACHE=off"):
        patch.setattr(os, "replace", full)
        assert _origin(program) == "compiled"
    assert list(cache.iterdir()) == []
    assert [_origin(program), _origin(program)] == ["compiled", "cache"]


def test_a_read_only_folder_is_a_warning(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read_only(**_: object) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(tempfile, "mkstemp", read_only)
    with pytest.warns(RuntimeWarning, match="cannot be written .Read-only file system"):
        assert _origin(program) == "compiled"
    assert list(cache.iterdir()) == []


def test_what_cannot_be_read_is_compiled(program: Program, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _origin(program)
    (path,) = cache.iterdir()
    path.unlink()
    path.mkdir()  # is a directory: it can neither be read nor replaced
    with pytest.warns(RuntimeWarning, match="cannot be (read|written)") as caught:
        assert _origin(program) == "compiled"
    assert ["cannot be read" in str(warning.message) for warning in caught] == [True, False]
    assert list(cache.iterdir()) == [path]


def test_without_a_home_there_is_a_warning(program: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless(_: str) -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(cache_module, "_folder", homeless)
    with pytest.warns(RuntimeWarning, match="home directory"):
        assert _origin(program) == "compiled"


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


# -- size ---------------------------------------------------------------------------------------------------


def _key(number: int) -> str:
    return f"{number:040x}"


def _used(cache: Path, ages: dict[int, float]) -> None:
    """Pretend that objects were last used some seconds ago."""
    for number, age in ages.items():
        os.utime(cache / f"{_key(number)}.o", (time.time() - age,) * 2)


def test_what_was_not_used_for_longest_goes_first(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(4):
        store(_key(number), b"x" * 1000)
    _used(cache, {0: 400, 1: 300, 2: 200, 3: 100})
    assert load(_key(0)) == b"x" * 1000  # and is used last from now on
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", "3.5 kB")
    store(_key(4), b"x" * 1000)
    assert [load(_key(number)) is not None for number in range(5)] == [True, False, False, True, True]


def test_what_was_just_written_stays(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", "10")
    for number in range(2):
        store(_key(number), b"x" * 1000)
    assert [path.name for path in cache.iterdir()] == [f"{_key(1)}.o"]


def test_files_of_others_are_left_alone(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.mkdir(mode=0o700)
    for name in ("mine.o", "notes.txt", f"{_key(1)}.txt", f"{_key(1)}0.o", "draft.tmp"):
        (cache / name).write_bytes(b"y" * 5000)
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", "1")
    store(_key(0), b"x")
    clear_cache()
    assert len(list(cache.iterdir())) == 5


def test_what_a_process_left_that_died_is_removed(cache: Path) -> None:
    store(_key(0), b"x")
    old, new = cache / f"{_key(1)}-abc_1.tmp", cache / f"{_key(2)}-abc_2.tmp"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (time.time() - 3600,) * 2)
    store(_key(3), b"x")
    assert (old.exists(), new.exists()) == (False, True)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("", 500_000_000),
        ("812", 812),
        ("2GB", 2_000_000_000),
        (" 1.5 MiB ", 1_500_000),
        (".5k", 500),
        ("9" * 400, 2**63),
    ],
)
def test_sizes(text: str, size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", text)
    assert size_bound() == size


@pytest.mark.parametrize("text", ["much", "-1", "0", "1e9", "nan", "5 XB", "0.5"])
def test_a_size_that_is_none_is_named(text: str, program: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", text)
    with pytest.raises(CacheError, match=f"NULLBODY_CACHE_SIZE='{text}' is no size"):
        compile_programs([program])
    monkeypatch.setenv("NULLBODY_CACHE", "off")
    assert _origin(program) == "compiled"


def test_info_and_clear(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert (cache_info().files, cache_info().oldest) == (0, None)
    for number in range(3):
        store(_key(number), b"x" * 100)
    (cache / f"{_key(7)}-abc.tmp").write_bytes(b"12345")
    _used(cache, {0: 500, 1: 50})
    found = cache_info()
    assert (found.folder, found.files, found.bytes, found.bound) == (cache, 3, 3 * 150 + 5, 500_000_000)
    assert found.oldest is not None and found.newest is not None
    assert abs(found.newest - found.oldest - 500) < 5
    assert clear_cache() == found
    assert list(cache.iterdir()) == []
    monkeypatch.setenv("NULLBODY_CACHE", "off")
    assert clear_cache().folder is None


def test_a_folder_cleared_while_it_is_written(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original, calls = os.replace, []

    def cleared_once(source: str, target: str) -> None:
        calls.append(source)
        if len(calls) == 1:
            clear_cache()
        original(source, target)

    monkeypatch.setattr(os, "replace", cleared_once)
    store(_key(0), b"x")
    assert len(calls) == 1 and load(_key(0)) is None
    store(_key(0), b"x")
    assert load(_key(0)) == b"x"
    assert len(list(cache.iterdir())) == 1


def test_processes_build_trim_and_clear_at_the_same_time(cache: Path) -> None:
    """Three write and load under a bound that one process alone exceeds, one clears again and again: no error, and
    whatever is loaded is what was written."""
    work = """
import os, sys, warnings
warnings.simplefilter("error")
from nullbody.kernels.cache import clear_cache, load, store
who, hits = int(sys.argv[1]), 0
for turn in range(300):
    if who == 3:
        clear_cache()
        continue
    key = f"{turn % 7:040x}"
    body = load(key)
    assert body in (None, key.encode() * 50), body
    hits += body is not None
    store(key, key.encode() * 50)
print(hits)
"""
    environment = {**os.environ, "NULLBODY_CACHE_SIZE": "9kB"}
    processes = [
        subprocess.Popen([sys.executable, "-c", work, str(who)], stdout=subprocess.PIPE, text=True, env=environment)
        for who in range(4)
    ]
    printed = [process.communicate(timeout=100)[0] for process in processes]
    assert [process.returncode for process in processes] == [0, 0, 0, 0]
    assert sum(map(int, printed)) > 0
    store(_key(0), b"x")
    assert sum(path.stat().st_size for path in cache.iterdir()) <= 9_000 + 2_100
    assert {path.suffix for path in cache.iterdir()} == {".o"}
