"""The files of the cache, and how many bytes they may take: those that were not used for longest go first.

A file's time of modification says when it was last used: `load` sets it. Only names that the cache itself gives are
touched, so that a folder may hold other files too.
"""

from __future__ import annotations

import os
import re
import stat
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from nullbody.errors import CacheError

__all__ = ["CacheFile", "cache_files", "object_file", "remove", "size_bound", "trim", "unfinished_prefix"]

_BOUND = "500MB"
_SIZE = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*([kMGT]?)i?B?\s*", re.IGNORECASE)
_UNITS = {"": 1, "K": 10**3, "M": 10**6, "G": 10**9, "T": 10**12}
_MOST = 2.0**63  # no disk is larger
_NAME = re.compile(r"[0-9a-f]{40}(\.o|-\w+\.tmp)")
_ABANDONED = 600.0  # [s] writing takes milliseconds: an unfinished file that is older belongs to a process that died


@dataclass(frozen=True)
class CacheFile:
    """A file of the cache.

    Attributes:
        path: where it is.
        bytes: its size.
        used: when it was last written or loaded [s since 1970].
        finished: whether it is an object; otherwise a process is writing it, or died while it did.
    """

    path: Path
    bytes: int
    used: float
    finished: bool


def size_bound() -> int:
    """How many bytes the cache may take: NULLBODY_CACHE_SIZE, such as 500MB (the default) or 2GB.

    Raises:
        CacheError: the variable holds no size, or one of 0.
    """
    text = os.environ.get("NULLBODY_CACHE_SIZE") or _BOUND
    found = _SIZE.fullmatch(text)
    bound = int(min(float(found[1]) * _UNITS[found[2].upper()], _MOST)) if found else 0
    if bound < 1:
        raise CacheError(
            f"NULLBODY_CACHE_SIZE={text!r} is no size: write a positive number of bytes, or one with a unit such as "
            f"{_BOUND} or 2GB; NULLBODY_CACHE=off keeps nothing"
        )
    return bound


def object_file(key: str) -> str:
    """The name of the object under a key."""
    return f"{key}.o"


def unfinished_prefix(key: str) -> str:
    """How the name of a file begins that is being written; it ends in .tmp."""
    return f"{key}-"


def cache_files(folder: Path) -> list[CacheFile]:
    """The cache's own files in a folder, those unused for longest first; none where there is no folder."""
    found = []
    with suppress(FileNotFoundError), os.scandir(folder) as entries:
        for entry in entries:
            if not _NAME.fullmatch(entry.name):
                continue
            with suppress(OSError):  # another process removed it
                status = entry.stat(follow_symlinks=False)
                if stat.S_ISREG(status.st_mode):
                    path, finished = folder / entry.name, entry.name.endswith(".o")
                    found.append(CacheFile(path, status.st_size, status.st_mtime, finished))
    return sorted(found, key=lambda file: (file.used, file.path.name))


def trim(folder: Path, bound: int, keep: str) -> None:
    """Remove what was used least recently until the rest fits, and unfinished files of processes that died.

    Args:
        folder: of the cache.
        bound: bytes that all objects may take.
        keep: name of a file that stays, whatever its size.
    """
    files = cache_files(folder)
    remove(file for file in files if not file.finished and file.used < time.time() - _ABANDONED)
    objects = [file for file in files if file.finished]
    excess = sum(file.bytes for file in objects) - bound
    for file in objects:
        if excess <= 0:
            return
        if file.path.name != keep:
            remove([file])
            excess -= file.bytes


def remove(files: Iterable[CacheFile]) -> list[CacheFile]:
    """Remove files; returns those that are gone. One that another process holds or has removed is left to it."""
    gone = []
    for file in files:
        with suppress(OSError):
            file.path.unlink()
            gone.append(file)
    return gone
