"""Shared libraries of a unit: by the compiler of this machine, or by the package ziglang, also for other platforms."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from nullbody.errors import OutputError, UnknownName

__all__ = ["PLATFORMS", "compiled", "compiler", "folder", "here"]

#: Names of FMI 2.0; what FMI 3.0, and zig, call them; the ending of a shared library.
PLATFORMS = {
    "linux64": ("x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    "win64": ("x86_64-windows", "x86_64-windows-gnu", ".dll"),
    "darwin64": ("x86_64-darwin", "x86_64-macos", ".dylib"),
    "aarch64-linux": ("aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    "aarch64-darwin": ("aarch64-darwin", "aarch64-macos", ".dylib"),
}
_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-shared")
_SECONDS = 600  # for a compilation


def here() -> str | None:
    """This machine's platform by its name in FMI 2.0, None where it has none."""
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    system = {"Linux": "linux", "Windows": "windows", "Darwin": "darwin"}.get(platform.system())
    return next((name for name, (tuple_, _, _) in PLATFORMS.items() if tuple_ == f"{machine}-{system}"), None)


def folder(target: str, fmi: int) -> str:
    """The folder of a platform's library within the unit."""
    return f"binaries/{target if fmi == 2 else PLATFORMS[target][0]}"


def compiler(target: str) -> list[str] | None:
    """The command that compiles for a platform: that of this machine for itself, else zig; None where there is none.

    CC names another compiler for this machine.

    Raises:
        UnknownName: there is no such platform.
    """
    if target not in PLATFORMS:
        raise UnknownName("platform", target, PLATFORMS)
    if target == here():
        for name in [os.environ["CC"]] if os.environ.get("CC") else ["cc", "gcc", "clang"]:
            if path := shutil.which(name):
                return [path]
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[target][1]]
    return None


def compiled(files: Path, names: Sequence[str], identifier: str, target: str) -> bytes | None:
    """The shared library of some C files for a platform; None where there is no compiler for it.

    Args:
        files: the folder they are in.
        names: those to compile.
        identifier: the library's name.
        target: the platform.

    Raises:
        UnknownName: there is no such platform.
        OutputError: the compiler refuses.
    """
    found = compiler(target)
    if found is None:
        return None
    made = files / f"{identifier}{PLATFORMS[target][2]}"
    position = [] if "windows" in PLATFORMS[target][0] else ["-fPIC"]
    command = [*found, *_FLAGS, *position, *names, "-lm", "-o", str(made)]
    try:
        done = subprocess.run(command, cwd=files, capture_output=True, text=True, timeout=_SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise OutputError(f"{found[0]} cannot compile the unit for {target}: {error}") from error
    if done.returncode or not made.exists():
        raise OutputError(
            f"{' '.join(found)} cannot compile the unit for {target}: {done.stderr.strip()[-2000:]}. "
            "Name another compiler in CC, or install the package ziglang"
        )
    return made.read_bytes()
