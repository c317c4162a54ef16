"""write_c: a model as a folder of C99."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path

from nullbody.equations import Equations
from nullbody.errors import InputError, OutputError
from nullbody.export.c.check import check_program
from nullbody.export.c.readme import build_file, readme
from nullbody.export.c.subject import Subject
from nullbody.export.c.text import header, source
from nullbody.export.c.trial import trial
from nullbody.export.target import replacement
from nullbody.kernels.c99 import Real, checked_real
from nullbody.kernels.c_name import check_prefix, identifiers
from nullbody.model import Model, build

__all__ = ["CFolder", "write_c"]

#: Names that <prefix>.h, <prefix>.c and the target <prefix> must not have: standard headers, own targets of CMake,
#: devices of Windows.
_FILES = frozenset(
    re.findall(
        r"\w+",
        """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint
    stdio stdlib string tgmath threads time uchar unistd wchar wctype
    all clean depend edit_cache help install package preinstall rebuild_cache test
    aux con nul prn
    """,
    )
)


@dataclass(frozen=True)
class CFolder:
    """Where a model lies as C.

    Attributes:
        folder: all files are in it.
        prefix: what every name in C begins with.
        header, source, test: the header, the source file, and the program that compares with stored numbers.
        files: all files.
    """

    folder: Path
    prefix: str
    header: Path
    source: Path
    test: Path
    files: tuple[Path, ...]


def write_c(
    equations: Equations | Model,
    folder: str | os.PathLike[str],
    *,
    real: Real = "double",
    prefix: str | None = None,
    seed: int = 0,
) -> CFolder:
    """Write a model as C99: <prefix>.h, <prefix>.c, <prefix>_test.c, CMakeLists.txt, README.md.

    The code allocates nothing, has no globals, and calls sin, cos and sqrt of libm alone. Kernels are straight lines;
    the functions around them check what goes in and comes out, by the same measures as a Model, and return a status.
    The dynamics are written in v itself (`Model.plain`): nothing is refused but what v makes singular.

    Args:
        equations: from `derive`; or a Model, whose parameter values become the defaults in C.
        folder: made where it does not exist; files of these names that are there are replaced.
        real: type of all numbers, "double" or "float".
        prefix: what every name begins with; by default the mechanism's name.
        seed: of the random state at which the test program compares.

    Raises:
        InputError: no equations, another type of numbers, a seed that is no whole number from 0, or a prefix that is
            no identifier or belongs to a header of C, a target of CMake or a device.
        AssemblyError: no state is found for the test program.
        OutputError: the folder cannot be written.
    """
    checked_real(real)
    if not isinstance(equations, Equations | Model):
        raise InputError(f"C is written of Equations or a Model, not of {type(equations).__name__}")
    if isinstance(seed, bool) or not isinstance(seed, Integral) or seed < 0:
        raise InputError(f"seed must be a whole number from 0, not {seed!r}")
    name = _file_name(equations.mechanism.name) if prefix is None else prefix
    _check_files(name)
    place = _made(Path(folder).expanduser())
    model = equations if isinstance(equations, Model) else build(equations)
    subject = Subject(model.plain, name, real)
    found = trial(subject, seed)
    texts = {
        f"{name}.h": header(subject),
        f"{name}.c": source(subject),
        f"{name}_test.c": check_program(subject, found),
        "CMakeLists.txt": build_file(subject),
        "README.md": readme(subject),
    }
    for file, text in texts.items():
        with replacement(place / file, Path(file).suffix.lower()) as draft, draft.open("x", encoding="utf-8") as stream:
            stream.write(text)
    paths = tuple(place / file for file in texts)
    return CFolder(place, name, paths[0], paths[1], paths[2], paths)


def _file_name(text: str) -> str:
    """A text as a C identifier that files can have too."""
    name = identifiers([text])[0]
    return f"{name}_" if name.lower() in _FILES else name


def _check_files(prefix: str) -> None:
    """Raise unless C functions, files and a target of CMake can have this name."""
    check_prefix(prefix)
    if prefix.lower() in _FILES:
        raise InputError(
            f"files cannot be called {prefix!r}: a header of C, a target of CMake or a device has that name already; "
            f"use {_file_name(prefix)!r}"
        )


def _made(folder: Path) -> Path:
    """The folder, made if need be, before any work is done for it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"the folder {folder} cannot be made: {error.strerror or error}. Choose a folder that you can write"
        ) from error
    return folder
