"""Programs as C: the bits of the interpreter, those of LLVM where both round alike, no warning of a strict compiler."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Sequence
from ctypes.util import find_library
from dataclasses import replace
from math import cos, prod, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nullbody
from nullbody.equations import programs
from nullbody.errors import InputError
from nullbody.expr import Graph
from nullbody.expr.tape import Tape
from nullbody.kernels import Program, c99
from nullbody.kernels.c99 import c_constant, c_functions
from nullbody.kernels.c_name import identifiers
from nullbody.kernels.llvm import module_ir
from nullbody.kernels.number import DOUBLE
from nullbody.kernels.trigonometry import RANGE
from tests.native import compiled

NUMBERS = {"double": (np.float64, ctypes.c_double), "float": (np.float32, ctypes.c_float)}
MECHANISMS = ("three_prs", "four_bar", "rolling_disc", "chaplygin_sleigh")


class Compiled:
    """Functions printed in C, called with arrays."""

    def __init__(self, folder: Path, made: Sequence[Program], real: str) -> None:
        declarations, definitions = c_functions(made, "nb", real)
        source = folder / f"{real}.c"
        source.write_text(f"#include <math.h>\n#include <stddef.h>\n{declarations}\n{definitions}", encoding="ascii")
        self.number = NUMBERS[real][0]
        self.library = ctypes.CDLL(str(compiled([source], folder / f"{real}.so", "-O0", "-shared", "-fPIC")))

    def __call__(self, program: Program, groups: Sequence[np.ndarray]) -> np.ndarray:
        given = [np.array(group, dtype=self.number) for group in groups]
        found = [np.full(prod(shape), np.nan, dtype=self.number) for _, shape in program.outputs]
        places = [ctypes.c_void_p(array.ctypes.data if array.size else None) for array in (*given, *found)]
        function = self.library[f"nb_{program.name}"]
        function.restype = None
        function(*places)
        return np.concatenate([*found, np.empty(0, dtype=self.number)])


def interpreted(program: Program, groups: Sequence[np.ndarray], real: str) -> np.ndarray:
    """The program run operation by operation in the numbers of C, with the functions of libm."""
    number = NUMBERS[real][0]
    tape = replace(program.tape, constants=tuple(number(x) for x in program.tape.constants))
    functions = {"sin": sin, "cos": cos, "sqrt": sqrt} if real == "double" else _single_functions()
    with np.errstate(all="ignore"):
        found = tape.run([number(x) for group in groups for x in group], functions)
    return np.array(found, dtype=number)


def _single_functions() -> dict[str, Callable[[Any], np.float32]]:
    """sinf, cosf and sqrtf as the linker finds them."""
    library, made = ctypes.CDLL(find_library("m")), {}
    for name in ("sin", "cos", "sqrt"):
        function = library[f"{name}f"]
        function.restype, function.argtypes = ctypes.c_float, [ctypes.c_float]
        made[name] = lambda x, function=function: np.float32(function(float(x)))
    return made


def bits(values: np.ndarray) -> list[bytes]:
    return [x.tobytes() for x in values + values.dtype.type(0)]  # 0 and -0 are one


def random_groups(program: Program, seed: int = 1) -> list[np.ndarray]:
    random = np.random.default_rng(seed)
    return [random.uniform(0.2, 1.5, size).astype(np.float32) for _, size in program.inputs]


@pytest.mark.parametrize("real", NUMBERS)
@pytest.mark.parametrize("part", [1000, 7])
def test_random_programs_have_the_bits_of_the_interpreter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random_program: Callable[..., Program], real: str, part: int
) -> None:
    monkeypatch.setattr(c99, "_PART", part)
    made = [random_program(seed, name=f"f{seed}") for seed in range(12)]
    code = Compiled(tmp_path, made, real)
    for program in made:
        groups = random_groups(program)
        assert bits(code(program, groups)) == bits(interpreted(program, groups, real)), program.name


@pytest.mark.parametrize("real", NUMBERS)
@pytest.mark.parametrize("name", MECHANISMS)
def test_routines_have_the_bits_of_the_interpreter(tmp_path: Path, name: str, real: str) -> None:
    """Every operation is there, with the signs and constants of the program: not one bit differs."""
    made = programs(nullbody.derive(nullbody.catalog.mechanism(name)))
    code = Compiled(tmp_path, made, real)
    for program in made:
        groups = random_groups(program)
        found = code(program, groups)
        assert np.isfinite(found).all()
        assert bits(found) == bits(interpreted(program, groups, real)), program.name


@pytest.mark.parametrize("name", MECHANISMS)
def test_routines_have_the_bits_of_llvm_where_both_round_alike(tmp_path: Path, name: str) -> None:
    """LLVM without fused multiply-adds and with libm's sines is the same arithmetic: the bits agree."""
    made = programs(nullbody.derive(nullbody.catalog.mechanism(name)))
    code, kernels = Compiled(tmp_path, made, "double"), _unfused(made)
    for program in made:
        groups = random_groups(program)
        source = np.concatenate([np.empty(0), *groups])
        target = np.zeros(max(1, len(program.tape.outputs)))
        kernels(program)(source.ctypes.data, target.ctypes.data)
        assert bits(code(program, groups)) == bits(target[: len(program.tape.outputs)]), program.name


def _unfused(made: Sequence[Program]) -> Callable[[Program], Callable[[int, int], None]]:
    """The LLVM functions, compiled without the flag `contract` and with no angle in the range of their own sines."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=2, jit=True)
    text = module_ir([(program, DOUBLE) for program in made], machine.triple, str(machine.target_data))
    text = text.replace(" contract ", " ").replace(DOUBLE.constant(RANGE), DOUBLE.constant(-1.0))
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(text), machine)
    engine.finalize_object()

    def function(program: Program) -> Callable[[int, int], None]:
        kind = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
        call = kind(engine.get_function_address(f"nb_{program.name}"))
        call.owner = engine
        return call

    return function


def test_long_programs_become_parts_of_limited_length(monkeypatch: pytest.MonkeyPatch) -> None:
    made = programs(nullbody.derive(nullbody.catalog.n_four_bar(6)))
    _, text = c_functions(made, "nb")
    whole = text.count("void nb_")
    monkeypatch.setattr(c99, "_PART", 100)
    _, text = c_functions(made, "nb")
    assert text.count("void nb_") > whole + 20
    longest = max(len(body.splitlines()) for body in re.split(r"^}$", text, flags=re.MULTILINE))
    assert longest < 100 * 4  # operations, and as many reads and hand-overs at most
    places = [int(size) for size in re.findall(r"double w\[(\d+)\];", text)]
    assert max(places) < sum(len(program.tape.code) for program in made) / 10  # places are used again


def test_declarations_are_the_heads_of_the_definitions() -> None:
    made = programs(nullbody.derive(nullbody.catalog.mechanism("four_bar")))
    declarations, definitions = c_functions(made, "fb")
    heads = [head for head in declarations.split(";\n") if head.strip()]
    assert len(heads) == len(made)
    for program, head in zip(made, heads, strict=True):
        assert head.strip() in definitions
        names = re.findall(r"double \*(\w+)", head)
        assert names == [name for name, _ in (*program.inputs, *program.outputs)]
        assert head.count("const double *") == len(program.inputs)


def test_names_that_c_cannot_take(tmp_path: Path) -> None:
    graph = Graph()
    x, y = graph.symbol("x */ y"), graph.symbol("two\nlines")
    inputs = (("double", 1), ("sin", 1), ("w", 0), ("t1", 0))
    outputs = (("double", ()), ("while", ()), ("2nd é", ()))
    tape = Tape.of([x + y, x - y, x * y], ["x */ y", "two\nlines"])
    program = Program("names", inputs, outputs, tape)
    head, _ = c_functions([program], "nb")
    assert re.findall(r"\*(\w+)", head) == ["double_", "sin_", "w_", "t1_", "double__", "while_", "n_2nd__"]
    found = Compiled(tmp_path, [program], "double")(program, [np.array([3.0]), np.array([5.0]), *[np.empty(0)] * 2])
    assert found.tolist() == [8.0, -2.0, 15.0]


def test_identifiers_differ_and_are_legal() -> None:
    found = identifiers(["a", "a", "a b", "a-b", "int", "", "_x", "1", "NAN"])
    assert found == ["a", "a_", "a_b", "a_b_", "int_", "n", "x", "n_1", "NAN_"]


def test_program_named_like_a_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random_program) -> None:
    monkeypatch.setattr(c99, "_PART", 20)
    made = [random_program(1, name="f"), random_program(2, name="f_part1")]
    code = Compiled(tmp_path, made, "double")
    for program in made:
        groups = random_groups(program)
        assert bits(code(program, groups)) == bits(interpreted(program, groups, "double"))


@pytest.mark.parametrize("value", [1.0, 0.1, 1e-30, 9.81, 1 / 3, 1e22, 123456789.0, 5e-324])
def test_constants_keep_all_digits(value: float) -> None:
    text = c_constant(value)
    assert float(text) == value
    assert re.search(r"[.e]", text)
    assert np.float32(c_constant(value, "float").removesuffix("f")) == np.float32(value)
    assert re.fullmatch(r"[0-9.e+-]+f", c_constant(value, "float"))


@pytest.mark.parametrize(("value", "real"), [(1e39, "float"), (float("inf"), "double"), (float("nan"), "float")])
def test_constants_that_the_type_cannot_hold(value: float, real: str) -> None:
    with pytest.raises(InputError, match=f"has no value as a {real}"):
        c_constant(value, real)


@pytest.mark.parametrize("prefix", ["", "3x", "a b", "a-b", "_a", "int", "é", "x;y"])
def test_prefixes_that_are_refused(random_program: Callable[..., Program], prefix: str) -> None:
    with pytest.raises(InputError, match="names in C cannot begin with"):
        c_functions([random_program(1)], prefix)


def test_types_and_names_that_are_refused(random_program: Callable[..., Program]) -> None:
    with pytest.raises(InputError, match="double or float, not for 'half'"):
        c_functions([random_program(1)], "nb", "half")
    with pytest.raises(InputError, match="two programs are named 'f'"):
        c_functions([random_program(1), random_program(2)], "nb")
