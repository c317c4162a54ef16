"""The cache of object files on disk.

Folder: the environment variable NULLBODY_CACHE, else nullbody in the user's cache folder; NULLBODY_CACHE=off: no cache.
A file is a checksum and an object; it is written under another name and renamed, so that it is there completely or
not at all, also with several processes. Native code is only loaded from what this user alone can write.
"""

from __future__ import annotations

import os
import stat
import sys
import tempfile
from hashlib import blake2b
from pathlib import Path

from nullbody.errors import CacheError

__all__ = ["cache_folder", "load", "store"]

_MAGIC = b"nullbody object 1\n"
_DIGEST = 32
_ADVICE = "set NULLBODY_CACHE to a folder that you can write, or NULLBODY_CACHE=off to compile every time"


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


def load(key: str) -> bytes | None:
    """The object under a key, or None where there is none or it is damaged.

    Raises:
        CacheError: folder or file belong to another user, others can write them, or they cannot be read.
    """
    folder = cache_folder()
    if folder is None:
        return None
    try:
        with (folder / _file(key)).open("rb") as stream:
            _distrust(folder, folder.stat())
            _distrust(folder / _file(key), os.fstat(stream.fileno()))
            content = stream.read()
    except FileNotFoundError:
        return None
    except CacheError:
        raise
    except OSError as error:
        raise CacheError(f"the kernel cache {folder} cannot be read ({error.strerror or error}); {_ADVICE}") from error
    start = len(_MAGIC) + _DIGEST
    body = content[start:]
    return body if content[:start] == _MAGIC + _checksum(body) else None


def store(key: str, body: bytes) -> None:
    """Write the object under a key; nothing is left behind where that fails.

    Raises:
        CacheError: the folder cannot be made or written, or others can write it.
    """
    folder = cache_folder()
    if folder is None:
        return
    temporary: Path | None = None
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        _distrust(folder, folder.stat())
        handle, name = tempfile.mkstemp(dir=folder, prefix=f"{key}-", suffix=".tmp")
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(_MAGIC + _checksum(body) + body)
        temporary.replace(folder / _file(key))
    except CacheError:
        raise
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        raise CacheError(
            f"the kernel cache {folder} cannot be written ({error.strerror or error}); {_ADVICE}"
        ) from error


def _file(key: str) -> str:
    return f"{key}.o"


def _checksum(body: bytes) -> bytes:
    return blake2b(body, digest_size=_DIGEST).digest()


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
