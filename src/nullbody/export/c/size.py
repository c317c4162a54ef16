"""How large the code in C is on a controller: compiled for an Arm Cortex-M7 by the compiler of the package ziglang."""

from __future__ import annotations

import struct
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from nullbody.errors import InputError, OutputError
from nullbody.export.c.folder import CFolder

__all__ = ["ObjectSize", "cortex_m7_size"]

_ALLOCATED, _WRITABLE, _NOBITS, _UNWIND = 2, 1, 8, 0x70000001  # flags and types of sections (ELF)
_SECTION = "<10I"  # an entry of the table of sections of a 32 bit object


class ObjectSize(NamedTuple):
    """Bytes of an object file, without sin, cos and sqrt of the controller's libm.

    Attributes:
        flash: instructions and constants.
        ram: variables; 0, since the code has no globals.
        functions: instructions of every function; a linker with --gc-sections drops those that nobody calls.
    """

    flash: int
    ram: int
    functions: dict[str, int]


def cortex_m7_size(written: CFolder) -> ObjectSize:
    """Compile the source file for a Cortex-M7 (hard floats, -Os) and measure the object; nothing is kept.

    Raises:
        InputError: the package ziglang is not installed.
        OutputError: the compiler refuses, or the disk is full.
    """
    spec = find_spec("ziglang")
    if spec is None or spec.origin is None:
        raise InputError("sizes need a cross compiler; run: python -m pip install 'nullbody[native]'")
    headers = Path(spec.origin).parent / "lib" / "libc" / "include"
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch) / "object.o"
        command = [sys.executable, "-m", "ziglang", "cc", "-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m7"]
        command += ["-std=c99", "-Os", "-ffunction-sections", "-Wall", "-Wextra", "-Werror", "-pedantic"]
        command += [f"-isystem{headers / folder}" for folder in ("generic-musl", "arm-linux-musl")]  # for math.h
        done = subprocess.run([*command, "-c", str(written.source), "-o", str(target)], capture_output=True, text=True)
        if done.returncode:
            raise OutputError(f"{written.source} cannot be compiled for a Cortex-M7: {done.stderr[-500:]}")
        return _size(target.read_bytes())


def _size(body: bytes) -> ObjectSize:
    """Sums over the sections of an ELF object that take memory; tables for unwinding are not linked in C."""
    (table,) = struct.unpack_from("<I", body, 0x20)
    entry, count, names = struct.unpack_from("<3H", body, 0x2E)
    sections = [struct.unpack_from(_SECTION, body, table + k * entry) for k in range(count)]
    texts = sections[names][4]  # where the names of the sections begin
    flash, ram, functions = 0, 0, dict[str, int]()
    for name, kind, flags, _, _, size, *_ in sections:
        if flags & _ALLOCATED and kind != _UNWIND:
            flash += size if kind != _NOBITS else 0
            ram += size if flags & _WRITABLE else 0
            label = body[texts + name : body.index(b"\0", texts + name)].decode()
            if label.startswith(".text.") and size:
                functions[label.removeprefix(".text.")] = size
    return ObjectSize(flash, ram, functions)
