from __future__ import annotations

import math
import threading
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from nullbody.errors import InputError
from nullbody.expr import Graph, sin, sqrt
from nullbody.expr.tape import Tape
from nullbody.kernels import Program, compile_programs, interpret, llvm

Z, EMPTY = np.array([0.3, -0.7]), np.zeros(0)


@pytest.mark.parametrize("seed", range(6))
def test_kernels_equal_the_interpreter(seed: int, random_program: Callable[..., Program]) -> None:
    program = random_program(seed, 3000 if seed == 0 else 150)
    kernel = compile_programs([program]).kernels["f"]
    rng = np.random.default_rng(seed)
    for _ in range(5):
        groups = rng.uniform(-2, 2, 5), EMPTY, rng.uniform(-2, 2, 2)
        for native, reference in zip(kernel(*groups), interpret(program, *groups), strict=True):
            assert native.shape == reference.shape
            np.testing.assert_allclose(native, reference, rtol=1e-12, atol=1e-14)


def test_long_programs_are_cut_into_pieces(
    random_program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(llvm, "_PIECE", 7)
    program = random_program(8, 400)
    kernel = compile_programs([program], wide=True).kernels["f"]
    groups = np.linspace(-1, 1, 5), EMPTY, Z
    for native, wide, reference in zip(
        kernel(*groups), kernel.batch(groups[0][None], EMPTY, Z), interpret(program, *groups), strict=True
    ):
        np.testing.assert_allclose(native, reference, rtol=1e-12, atol=1e-14)
        assert np.array_equal(wide[0], native)


def test_every_sign_reaches_its_output() -> None:
    graph = Graph()
    a, b = graph.symbol("a"), graph.symbol("b")
    forms = [-(a * b), -a - b, b - a, -(a + b) * a, -1 / (a + b), sin(-a), -sin(a) * b, sqrt(-(a - b)), -sqrt(b), 2 - a]
    program = Program("f", (("x", 2),), (("r", (10,)),), Tape.of(forms, ["a", "b"]))
    x, y = 0.4, 1.7
    expected = [-x * y, -x - y, y - x, -(x + y) * x, -1 / (x + y), -math.sin(x), -math.sin(x) * y, math.sqrt(y - x)]
    (result,) = compile_programs([program]).kernels["f"]([x, y])
    np.testing.assert_allclose(result, [*expected, -math.sqrt(y), 2 - x], rtol=4e-16)


def test_negative_operands_of_a_tape_are_honoured() -> None:
    code = (
        ("symbol", 0, 0),
        ("symbol", 1, 0),
        ("add", 1, 2),
        ("add", 1, 3),
        ("sub", 1, 3),
        ("mul", 1, 3),
        ("inv", 1, 0),
    )
    tape = Tape(("a", "b"), (), (*code, ("cos", 1, 0), ("sin", 1, 0), ("sqrt", 7, 0)), (4, 6, 8, 10, 13, 15, 17, 19))
    program = Program("f", (("x", 2),), (("r", (8,)),), tape)
    x = [0.4, 1.7]
    np.testing.assert_allclose(compile_programs([program]).kernels["f"](x)[0], interpret(program, x)[0], rtol=4e-16)


def test_results_are_new_arrays(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(1)]).kernels["f"]
    first = kernel(np.zeros(5), EMPTY, Z)
    kept = [r.copy() for r in first]
    kernel(np.ones(5), EMPTY, -Z)
    assert all(np.array_equal(r, k) for r, k in zip(first, kept, strict=True))
    assert kernel.program.name == "f"
    assert "f(x[5], y[0], z[2]) -> A[3, 4], s[], v[2]" in repr(kernel)


@pytest.mark.parametrize(
    "x", [[1, 2, 3, 4, 5], (1.0, 2.0, 3.0, 4.0, 5.0), np.arange(1, 6), np.arange(1.0, 11.0)[::2] / 2 + 0.5]
)
def test_any_vector_of_real_numbers_will_do(x: object, random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(2)]).kernels["f"]
    expected = kernel(np.arange(1.0, 6.0), EMPTY, Z)
    assert all(np.array_equal(a, b) for a, b in zip(kernel(x, [], Z), expected, strict=True))


@pytest.mark.parametrize(
    ("x", "says"),
    [
        (np.zeros(4), r"input 'x' has shape \(4,\), not \(5,\)"),
        (np.zeros((5, 1)), "input 'x' has shape"),
        (1.0, r"input 'x' has shape \(\)"),
        (np.zeros(5, dtype=complex), "input 'x' holds complex128"),
        (["a"] * 5, "input 'x' holds"),
        ([Fraction(1)] * 5, "input 'x' holds object"),
        ([[1.0], [1.0, 2.0], 1, 1, 1], "input 'x' is no array of numbers"),
    ],
)
def test_wrong_inputs_are_named(x: object, says: str, random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(3)]).kernels["f"]
    with pytest.raises(InputError, match=says) as caught:
        kernel(x, EMPTY, Z)
    assert "kernel f(x[5], y[0], z[2])" in str(caught.value)
    with pytest.raises(InputError, match="takes 3 input groups, not 1"):
        kernel(np.zeros(5))


def test_threads_do_not_mix_their_data(random_program: Callable[..., Program]) -> None:
    program = random_program(4, 400)
    kernel = compile_programs([program]).kernels["f"]
    wrong: list[int] = []

    def work(number: int) -> None:
        groups = np.linspace(0, number / 4, 5), EMPTY, Z * number
        expected = interpret(program, *groups)
        for _ in range(300):
            if not all(np.allclose(a, b, rtol=1e-11) for a, b in zip(kernel(*groups), expected, strict=True)):
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_an_input_may_call_the_kernel_while_it_is_read(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(5)]).kernels["f"]

    class Vector:
        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            kernel(np.full(5, 9.0), EMPTY, Z)
            return Z

    x = np.linspace(0, 1, 5)
    assert np.array_equal(kernel(x, EMPTY, Vector())[0], kernel(x, EMPTY, Z)[0])


def test_programs_compiled_together_have_different_names(random_program: Callable[..., Program]) -> None:
    with pytest.raises(InputError, match="two programs are named 'f'"):
        compile_programs([random_program(1), random_program(2)])


def test_empty_programs_work() -> None:
    program = Program("nothing", (("p", 0),), (("r", (0, 3)),), Tape((), (), (), ()))
    assert compile_programs([program]).kernels["nothing"]([])[0].shape == (0, 3)
