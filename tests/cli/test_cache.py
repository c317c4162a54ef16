"""cache: what it holds, and clearing it."""

from __future__ import annotations

from pathlib import Path

import pytest

from nullbody.kernels.cache import store


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache folder of this test, with two files in it."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("NULLBODY_CACHE", str(folder))
    for number in range(2):
        store(f"{number:040x}", b"x" * 2000)
    return folder


def test_info_is_the_default(nullbody, cache: Path) -> None:
    ended = nullbody("cache")
    assert ended.code == 0 and ended.out == nullbody("cache --info").out
    assert str(cache) in ended.out and "files   2, 4.1 kB of at most 500 MB" in ended.out


def test_json(nullbody, cache: Path) -> None:
    found = nullbody("cache --json").json
    assert (found["folder"], found["files"], found["bytes"], found["cleared"]) == (str(cache), 2, 4100, False)
    assert found["oldest"] <= found["newest"]


def test_clear_removes_the_files(nullbody, cache: Path) -> None:
    assert "removed 2 files, 4.1 kB" in nullbody("cache --clear").out
    assert list(cache.iterdir()) == []
    assert nullbody("cache --clear --json").json["files"] == 0


def test_off_and_what_is_refused(nullbody, monkeypatch: pytest.MonkeyPatch) -> None:
    assert nullbody("cache --info --clear").code == 2
    monkeypatch.setenv("NULLBODY_CACHE_SIZE", "huge")
    ended = nullbody("cache")
    assert ended.code == 2 and "NULLBODY_CACHE_SIZE='huge' is no size" in ended.err
    monkeypatch.setenv("NULLBODY_CACHE", "off")
    assert "off" in nullbody("cache").out
