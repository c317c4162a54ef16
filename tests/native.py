"""A C compiler for the tests: that of the system, else the one of the package ziglang; every warning is an error."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import pytest

__all__ = ["WARNINGS", "compiled", "compiler"]

WARNINGS = (
    *("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wfloat-conversion", "-Wshadow"),
    *("-Wstrict-prototypes", "-Wmissing-prototypes", "-Wvla", "-Werror", "-pedantic"),
)


def compiler() -> list[str]:
    """The command; skips the test where there is none."""
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return [path]
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    pytest.skip("needs a C compiler; the extra native has one")


def compiled(sources: Sequence[Path], target: Path, *options: str) -> Path:
    """The sources compiled and linked: C99, no fused multiply-adds, any warning an error."""
    command = [*compiler(), "-std=c99", "-O1", "-ffp-contract=off", *WARNINGS, *options]
    done = subprocess.run([*command, *map(str, sources), "-o", str(target), "-lm"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return target
