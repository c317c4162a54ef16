from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nullbody.errors import UnknownName
from nullbody.expr import Graph, cos, sin
from nullbody.expr.tape import Tape
from nullbody.kernels import Composer, Program, interpret
from nullbody.kernels.compose import part

EMPTY = np.zeros(0)


def _inputs(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-2, 2, 5), EMPTY, rng.uniform(-2, 2, 2)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("outputs", [("v",), ("v", "A"), ("s", "v", "A"), ()])
def test_a_part_gives_what_the_whole_gives(
    seed: int, outputs: tuple[str, ...], random_program: Callable[..., Program]
) -> None:
    program = random_program(seed, 120)
    some = part(program, outputs, "some")
    whole = dict(zip([name for name, _ in program.outputs], interpret(program, *_inputs(seed)), strict=True))
    assert [name for name, _ in some.outputs] == list(outputs)
    for name, value in zip(outputs, interpret(some, *_inputs(seed)), strict=True):
        assert np.array_equal(value, whole[name])


def test_a_part_evaluates_only_what_it_needs() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    program = Program("f", (("x", 1), ("y", 1)), (("a", ()), ("b", ())), Tape.of([sin(x) * y, cos(y) + 1], ["x", "y"]))
    assert part(program, ("a",)).tape.operations.trig == 1
    assert part(program, ("b",)).tape.operations.mul == 0
    assert part(program, ("a", "b")).tape.operations == program.tape.operations
    assert part(program, ()).tape.code == ()


def test_what_programs_share_is_evaluated_once() -> None:
    graph = Graph()
    x = graph.symbol("x")
    first = Program("f", (("x", 1),), (("a", ()),), Tape.of([sin(x) * sin(x) + x], ["x"]))
    second = Program("g", (("x", 1),), (("b", ()),), Tape.of([-(sin(x) * sin(x)) * 3], ["x"]))
    composer = Composer("both", [("x", 1)])
    a, b = composer.call(first)["a"], composer.call(second)["b"]
    both = composer.program({"a": ((), a), "b": ((), b)})
    assert both.tape.operations.trig == 1
    assert both.tape.operations.mul == 2
    assert np.array_equal(interpret(both, [0.3]), [interpret(first, [0.3])[0], interpret(second, [0.3])[0]])


def test_results_are_inputs_of_another_program() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    inner = Program("f", (("x", 1),), (("z", (2,)),), Tape.of([x * x, -x], ["x"]))
    outer = Program("g", (("z", 2),), (("r", ()),), Tape.of([x - y], ["x", "y"]))
    composer = Composer("of", [("unused", 3), ("x", 1)])
    made = composer.program({"r": ((), composer.call(outer, composer.call(inner))["r"])})
    assert interpret(made, np.zeros(3), [3.0])[0] == 12.0
    assert made.inputs == (("unused", 3), ("x", 1))


def test_zeros_of_both_signs_stay_apart() -> None:
    programs = [Program("f", (), (("c", ()),), Tape((), (value,), (("const", 0, 0),), (0,))) for value in (0.0, -0.0)]
    composer = Composer("zeros", [])
    refs = [composer.call(program)["c"][0] for program in programs]
    values = interpret(composer.program({"c": ((2,), refs)}))[0]
    assert np.array_equal(np.signbit(values), [False, True])


def test_unknown_names_are_named(random_program: Callable[..., Program]) -> None:
    with pytest.raises(UnknownName, match="no output 'w'; known: A, s, v"):
        part(random_program(0), ("w", "v"))
    with pytest.raises(UnknownName, match="no input group 'x'"):
        Composer("f", [("z", 2)]).call(random_program(0))
