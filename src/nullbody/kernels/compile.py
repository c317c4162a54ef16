"""Programs to native code for this machine's processor, by way of LLVM or of the cache."""

from __future__ import annotations

import marshal
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from hashlib import blake2b
from types import MappingProxyType
from typing import Any, Literal

from nullbody.errors import InputError
from nullbody.kernels.block import Code
from nullbody.kernels.cache import load, store
from nullbody.kernels.kernel import Kernel
from nullbody.kernels.llvm import function_name, module_ir
from nullbody.kernels.number import BLOCK, DOUBLE, Number
from nullbody.kernels.program import Program

__all__ = ["Library", "compile_blocks", "compile_programs", "compile_text"]

#: Part of every key of the cache; change it whenever the printed code or the calling convention changes.
_FORMAT = 3
_OPTIMISATION = 2


@dataclass(frozen=True)
class Library:
    """Kernels that share one piece of native code.

    Attributes:
        kernels: the kernel of every program, by name.
        origin: "compiled" where LLVM ran, "cache" where the object file was on disk.
    """

    kernels: Mapping[str, Kernel]
    origin: Literal["compiled", "cache"]


def compile_programs(programs: Sequence[Program], wide: bool = False) -> Library:
    """Native kernels of some programs, all in one object file.

    Args:
        programs: the programs; their names differ.
        wide: compile the functions over blocks of 8 states (`Kernel.batch`) along; otherwise each one is compiled when
            it is first asked for.

    Raises:
        InputError: two programs have one name.
        CacheError: the cache cannot be trusted, or its settings make no sense; NULLBODY_CACHE=off does without.
    """
    names = [program.name for program in programs]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError(f"two programs are named {twice[0]!r}; the names of programs compiled together differ")
    functions = [(program, number) for number in (DOUBLE, _vector(64))[: 1 + wide] for program in programs]
    engine, origin = _engine(functions)
    kernels = {
        p.name: Kernel(p, _code(engine, p, DOUBLE), partial(_wide, p, engine if wide else None)) for p in programs
    }
    return Library(MappingProxyType(kernels), origin)


def compile_blocks(program: Program, bits: int = 64) -> Code:
    """The function of a program over blocks of 8 states alone, void(in, out, int64 blocks).

    Raises:
        CacheError: the cache cannot be read, written or trusted.
    """
    return _wide(program, None, bits)


@cache
def compile_text(name: str, text: str) -> Code:
    """A native function that is written in LLVM IR, without target lines; compiled once a process.

    Raises:
        CacheError: the cache cannot be read, written or trusted.
    """
    digest = blake2b(repr((_FORMAT, _OPTIMISATION, _host(), *_versions(), text)).encode(), digest_size=20)
    body = load(digest.hexdigest())
    if body is None:
        body = _emitted(lambda triple, layout: f'target datalayout = "{layout}"\ntarget triple = "{triple}"\n{text}')
        store(digest.hexdigest(), body)
    engine = _loaded(body)
    return Code(engine.get_function_address(name), engine)


def _wide(program: Program, engine: Any | None, bits: int) -> Code:
    """The function of a program over blocks, from an engine that has the one of doubles or else from its own."""
    number = _vector(bits)
    if engine is None or bits != DOUBLE.bits:
        engine, _ = _engine([(program, number)])
    return _code(engine, program, number)


def _code(engine: Any, program: Program, number: Number) -> Code:
    return Code(engine.get_function_address(function_name(program, number)), engine)


def _engine(functions: Sequence[tuple[Program, Number]]) -> tuple[Any, Literal["compiled", "cache"]]:
    """An engine that holds the functions, and where they came from."""
    key = _key(functions)
    if (body := load(key)) is not None:
        return _loaded(body), "cache"
    body = _object_file(functions)
    store(key, body)
    return _loaded(body), "compiled"


def _vector(bits: int) -> Number:
    """What fills a register of this machine, but no more than a block."""
    features = _host()[2].split(",")
    register = 512 if "+avx512f" in features else 256 if "+avx" in features else 128
    return Number(min(BLOCK, register // bits), bits)


@cache
def _host() -> tuple[str, str, str]:
    """(triple, processor, features) of this machine."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _machine() -> Any:
    """LLVM's code generator for this machine; a new one every time, for an engine owns the one it is given."""
    import llvmlite.binding as llvm

    triple, processor, features = _host()
    target = llvm.Target.from_triple(triple)
    return target.create_target_machine(cpu=processor, features=features, opt=_OPTIMISATION, jit=True)


def _key(functions: Sequence[tuple[Program, Number]]) -> str:
    """Digest of all that determines the object file; made from the tapes, so that a warm start prints no IR."""
    digest = blake2b(digest_size=20)
    digest.update(repr((_FORMAT, _OPTIMISATION, _host(), *_versions())).encode())
    for program, number in functions:
        tape, kind = program.tape, (number.lanes, number.bits, len(program.tape.inputs))
        digest.update(marshal.dumps((kind, program.name, tape.constants, tape.code, tape.outputs), 2))
    return digest.hexdigest()


def _versions() -> tuple[object, str]:
    """Of LLVM and of its binding."""
    import llvmlite
    import llvmlite.binding as llvm

    return llvm.llvm_version_info, llvmlite.__version__


def _object_file(functions: Sequence[tuple[Program, Number]]) -> bytes:
    return _emitted(partial(module_ir, functions))


def _emitted(text: Callable[[str, str], str]) -> bytes:
    """The object file of a module that is printed for a target triple and a data layout."""
    import llvmlite.binding as llvm

    machine = _machine()
    module = llvm.parse_assembly(text(machine.triple, str(machine.target_data)))
    return bytes(machine.emit_object(module))


def _loaded(body: bytes) -> Any:
    """An execution engine with the object file loaded, relocated and executable."""
    import llvmlite.binding as llvm

    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(body))
    engine.finalize_object()
    return engine
