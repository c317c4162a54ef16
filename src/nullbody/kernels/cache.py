"""The cache on disk: object files, and what models are made from.

Folder: the environment variable NULLBODY_CACHE, else nullbody in the user's cache folder; NULLBODY_CACHE=off: no cache.
A file is an object, and before it a checksum of its key and of itself, so that no object is taken for another; it is
written under another name and renamed, so that it is there completely or not at all, also with several processes.
Native code is only loaded from what this user alone can write.

A cache saves time and nothing else: where it cannot be read or written (a read-only folder, a full disk, no home) there
is a warning, and the code is compiled. What could be somebody else's code, and settings that make no sense, are errors.
"""

from __future__ import annotations

import os
import stat
import sys
import tempfile
import warnings
from contextlib import suppress
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path

from nullbody.errors import CacheError
from nullbody.kernels.cache_files import (
    CacheFile,
    cache_files,
    object_file,
    remove,
    size_bound,
    trim,
    unfinished_prefix,
)

__all__ = ["CacheInfo", "cache_folder", "cache_info", "clear_cache", "load", "store"]

_MAGIC = b"nullbody object 2\n"
_DIGEST = 32
_ADVICE = "set NULLBODY_CACHE to a folder that you can write, or NULLBODY_CACHE=off to compile every time"


@dataclass(frozen=True)
class CacheInfo:
    """What the cache holds.

    Attributes:
        folder: where it is; nothing where NULLBODY_CACHE is "off".
        files: number of objects.
        bytes: their size, with that of unfinished files.
        bound: bytes that objects may take (NULLBODY_CACHE_SIZE).
        oldest, newest: when the objects that were used first and last were used [s since 1970].
    """

    folder: Path | None
    files: int
    bytes: int
    bound: int
    oldest: float | None
    newest: float | None


def cache_folder() -> Path | None:
    """The folder of the cache, or None where NULLBODY_CACHE is "off".

    Raises:
        CacheError: the user has no home folder.
    """
    chosen = os.environ.get("NULLBODY_CACHE", "")
    if chosen.lower() == "off":
        return None
    try:
        return _folder(chosen)
    except RuntimeError as error:
        raise CacheError(f"there is no folder for the kernel cache ({error}); {_ADVICE}") from error


def _folder(chosen: str) -> Path:
    if chosen:
        return Path(chosen).expanduser().absolute()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "nullbody" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "nullbody"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "nullbody"


def _usable_folder() -> Path | None:
    """The folder; a user without a home has none, and a warning."""
    try:
        return cache_folder()
    except CacheError as error:
        warnings.warn(str(error), RuntimeWarning, stacklevel=3)
        return None


def load(key: str) -> bytes | None:
    """The object under a key, or None where there is none, it is damaged or another's, or (with a warning)
    it cannot be read.

    Raises:
        CacheError: the folder is a file, folder or file belong to another user or others can write them, or
            NULLBODY_CACHE_SIZE is no size.
    """
    folder = _usable_folder()
    if folder is None:
        return None
    size_bound()
    path = folder / object_file(key)
    try:
        with path.open("rb") as stream:
            _distrust(folder, folder.stat())
            _distrust(path, os.fstat(stream.fileno()))
            content = stream.read()
    except FileNotFoundError:
        return None
    except CacheError:
        raise
    except OSError as error:
        _report(error, f"the kernel cache {folder} cannot be read")
        return None
    start = len(_MAGIC) + _DIGEST
    body = content[start:]
    if content[:start] != _MAGIC + _checksum(key, body):
        return None
    with suppress(OSError):  # it was used now: see `trim`
        os.utime(path)
    return body


def store(key: str, body: bytes) -> None:
    """Write the object under a key, and remove what was used least recently where the cache exceeds its bound.

    Where it cannot be written there is a warning, and nothing is left behind.

    Raises:
        CacheError: the folder is a file, it belongs to another user or others can write it, or NULLBODY_CACHE_SIZE is
            no size.
    """
    folder = _usable_folder()
    if folder is None:
        return
    bound = size_bound()
    try:
        _write(folder, key, body)
        trim(folder, bound, object_file(key))
    except CacheError:
        raise
    except OSError as error:
        if isinstance(error, FileNotFoundError) and folder.is_dir():
            return  # another process cleared the cache meanwhile, this file with it
        _report(error, f"the kernel cache {folder} cannot be written")


def _write(folder: Path, key: str, body: bytes) -> None:
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    _distrust(folder, folder.stat())
    handle, name = tempfile.mkstemp(dir=folder, prefix=unfinished_prefix(key), suffix=".tmp")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(_MAGIC + _checksum(key, body) + body)
        temporary.replace(folder / object_file(key))
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def cache_info() -> CacheInfo:
    """What the cache holds.

    Raises:
        CacheError: the folder cannot be read, or NULLBODY_CACHE_SIZE is no size.
    """
    folder = cache_folder()
    if folder is None:
        return CacheInfo(None, 0, 0, 0, None, None)
    bound, files = size_bound(), _listed(folder)
    used = [file.used for file in files if file.finished]
    size = sum(file.bytes for file in files)
    return CacheInfo(folder, len(used), size, bound, min(used, default=None), max(used, default=None))


def clear_cache() -> CacheInfo:
    """Remove all files of the cache; returns what it held. Programs that run keep the code that they loaded.

    Raises:
        CacheError: the folder cannot be read, or files cannot be removed.
    """
    before, folder = cache_info(), cache_folder()
    if folder is not None:
        remove(_listed(folder))
        left = [file for file in _listed(folder) if file.finished and file.used <= (before.newest or 0)]
        if left:
            raise CacheError(
                f"{len(left)} files of the kernel cache {folder} cannot be removed, {left[0].path.name} among them: "
                "they belong to another user, the folder is read-only, or a running program holds them"
            )
    return before


def _listed(folder: Path) -> list[CacheFile]:
    try:
        return cache_files(folder)
    except OSError as error:
        raise CacheError(f"the kernel cache {folder} cannot be read ({error.strerror or error}); {_ADVICE}") from error


def _report(error: OSError, what: str) -> None:
    """An error where NULLBODY_CACHE names a file, a warning where the circumstances are to blame."""
    message = f"{what} ({error.strerror or error}); {_ADVICE}"
    if isinstance(error, NotADirectoryError | FileExistsError):
        raise CacheError(message) from error
    warnings.warn(f"{message}. The code is compiled, and will be again", RuntimeWarning, stacklevel=3)


def _checksum(key: str, body: bytes) -> bytes:
    return blake2b(body, digest_size=_DIGEST, key=key.encode()).digest()


def _distrust(path: Path, status: os.stat_result) -> None:
    """Raise CacheError where somebody else could have put native code there."""
    if sys.platform == "win32":
        return
    if status.st_uid != os.geteuid():
        raise CacheError(
            f"{path} belongs to user {status.st_uid}, not to you ({os.geteuid()}): "
            f"its native code is not loaded; {_ADVICE}"
        )
    if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise CacheError(
            f"other users can write {path}: its native code is not loaded; run `chmod go-w {path}`, "
            f"or set NULLBODY_CACHE to another folder (NULLBODY_CACHE=off: no cache)"
        )
