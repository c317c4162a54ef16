"""Where a file goes: checked before the work, replaced in one piece after it."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from nullbody.errors import OutputError

__all__ = ["check_target", "replacement"]


def check_target(path: str | os.PathLike[str], *suffixes: str) -> Path:
    """The path of a file that can be written, checked before any work is done for it.

    Args:
        path: where the file will be.
        suffixes: the endings that it may have, such as ".csv".

    Raises:
        OutputError: another ending, a folder in its place, or a folder that is missing or not writable.
    """
    target = Path(path).expanduser()
    if os.path.isdir(target):  # noqa: PTH112, Path.is_dir raises where a name is too long
        raise OutputError(
            f"{target} cannot be written: it is a folder. Name a file in it, {target / f'run{suffixes[0]}'}"
        )
    if target.suffix.lower() not in suffixes:
        raise OutputError(f"{target} cannot be written: its name must end in {' or '.join(suffixes)}")
    folder = target.parent
    if not folder.exists():
        raise OutputError(f"{target} cannot be written: the folder {folder} does not exist. Make it first")
    if not folder.is_dir():
        raise OutputError(f"{target} cannot be written: {folder} is a file, not a folder. Name another folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"{target} cannot be written: the folder {folder} is not writable for you. {_ADVICE}")
    return target


@contextmanager
def replacement(path: str | os.PathLike[str], *suffixes: str) -> Iterator[Path]:
    """A new file beside `path` that takes its place when the block succeeds, and vanishes when it fails.

    Raises:
        OutputError: as `check_target`, or the system refused to write; nothing is left behind.
    """
    target = check_target(path, *suffixes)
    real = target.resolve()  # a link keeps pointing at its file
    draft = real.with_name(f".{real.stem}-{secrets.token_hex(4)}{real.suffix}")
    try:
        yield draft
        draft.replace(real)
    except OSError as error:
        raise OutputError(f"{target} cannot be written: {error.strerror or error}. {_ADVICE}") from error
    finally:
        with suppress(OSError):  # it is not there, or its name is too long to be
            draft.unlink()


_ADVICE = "Choose a folder that you can write and that has space"
