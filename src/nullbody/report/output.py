"""Writing the report: the folder is tried before anything is computed, and files appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from nullbody.errors import OutputError

__all__ = ["usable_folder", "write_texts", "written"]

_ADVICE = "give another folder, or free this one"


def usable_folder(out: str | Path, files: Sequence[str] = ()) -> Path:
    """The folder, made where it is missing, after a file has been written and removed in it.

    Args:
        out: the folder.
        files: what will be written in it.

    Raises:
        OutputError: it is no folder, or it cannot be made or written.
    """
    folder = Path(out).expanduser()
    for part in (folder, *folder.parents):
        if part.exists() and not part.is_dir():
            raise OutputError(f"the report cannot be written to {folder}: {part} is a file, not a folder; {_ADVICE}")
    for name in files:
        if (folder / name).is_dir():
            raise OutputError(f"the report cannot be written to {folder}: {name} in it is a folder; {_ADVICE}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, prefix=".nullbody-", suffix=".tmp")
        os.close(handle)
        Path(name).unlink()
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"the report cannot be written to {folder} ({reason}); {_ADVICE}") from error
    return folder


@contextmanager
def written(path: Path) -> Iterator[Path]:
    """A temporary file beside a path, with its suffix; it takes the path's place when the block ends well.

    Raises:
        OutputError: it cannot be written; nothing is left behind.
    """
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".nullbody-", suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror or error}); {_ADVICE}") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_texts(folder: Path, texts: Mapping[str, str]) -> None:
    """Write several files: all are complete under other names before the first takes its place.

    Raises:
        OutputError: one cannot be written; those that were there before stay as they are.
    """
    if not texts:
        return
    (name, text), *others = texts.items()
    with written(folder / name) as temporary:
        temporary.write_text(text, encoding="utf-8")
        write_texts(folder, dict(others))
