"""Text of a model file: bounded, decoded, and with the name that messages give it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nullbody.errors import ModelFileError, located

__all__ = ["LARGEST", "Document", "Source", "document"]

#: Most bytes of a model file: far more than any mechanism needs, little enough to be read in seconds.
LARGEST = 2**20

#: A file's path, or its text: a text has a line break, or starts with "<" or "{".
Source = str | Path


@dataclass(frozen=True)
class Document:
    """A text that has been read.

    Attributes:
        text: without a byte order mark.
        file: its path, or "text".
        suffix: of the path, in lower case.
    """

    text: str
    file: str = "text"
    suffix: str = ""

    def error(self, what: str, place: str = "", line: int = 0) -> ModelFileError:
        """An error at a place of this document."""
        return ModelFileError(what, file=self.file, place=place, line=line)

    def located(self, error: Exception, place: str = "", line: int = 0) -> Exception:
        """The same error, its message preceded by the place in this document."""
        where = located(self.file, place, line)
        if not str(error).startswith(self.file):
            error.args = (f"{where}: {error}",)
        return error


def document(source: Source) -> Document:
    """Read a model file.

    Args:
        source: a path, or the text itself.

    Raises:
        ModelFileError: there is no such file, it is larger than `LARGEST`, or it is no UTF-8 text.
    """
    if not isinstance(source, str | Path):
        raise ModelFileError(f"a model is read from a path or a text, not from {type(source).__name__}")
    if isinstance(source, str) and ("\n" in source or source.lstrip()[:1] in ("<", "{")):
        try:
            size = len(source.encode())
        except UnicodeEncodeError as error:
            raise ModelFileError(f"character {error.start} cannot be written as UTF-8: this is no text") from None
        if size > LARGEST:
            raise _too_large("text", size)
        return Document(source.removeprefix("\ufeff"))
    path = Path(source)
    name = str(path)
    try:
        if path.is_dir():
            raise ModelFileError("this is a directory: give the path of a file in it", file=name)
        if not path.is_file():
            raise ModelFileError("there is no such file; give a path to a .yaml, .xml or .urdf file", file=name)
        size = path.stat().st_size
        if size > LARGEST:
            raise _too_large(name, size)
        data = path.read_bytes()[: LARGEST + 1]
        return Document(data.decode("utf-8-sig"), name, path.suffix.lower())
    except UnicodeDecodeError as error:
        raise ModelFileError(
            f"byte {error.start} is not UTF-8: this is no text file, or it has another encoding", file=name
        ) from None
    except (OSError, ValueError) as error:
        if isinstance(error, ModelFileError):
            raise
        raise ModelFileError(f"it cannot be read: {error}", file=name) from None


def _too_large(name: str, size: int) -> ModelFileError:
    return ModelFileError(
        f"{size} bytes are more than a model file may have ({LARGEST}): is this a model file? Meshes and data belong "
        "in files of their own",
        file=name,
    )
