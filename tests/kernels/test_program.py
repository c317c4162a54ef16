from __future__ import annotations

import numpy as np
import pytest

from nullbody.errors import InputError
from nullbody.expr import Graph
from nullbody.expr.tape import Tape
from nullbody.kernels import Program, interpret

GRAPH = Graph()
X, Y = GRAPH.symbol("x"), GRAPH.symbol("y")
TAPE = Tape.of([X + Y, X * Y], ["x", "y"])


@pytest.mark.parametrize(
    ("name", "inputs", "outputs", "says"),
    [
        ("f g", (("x", 2),), (("r", (2,)),), "C function"),
        ("f", (("x", 1),), (("r", (2,)),), r"x\[1\] need 1 inputs, the tape has 2"),
        ("f", (("x", 3), ("y", -1)), (("r", (2,)),), "input groups"),
        ("f", (("x", 2),), (("r", (2, 2)),), "4 outputs, the tape has 2"),
        ("f", (("x", 1), ("x", 1)), (("r", (2,)),), "'x' twice"),
    ],
)
def test_wrong_signatures_are_refused(name: str, inputs: tuple, outputs: tuple, says: str) -> None:
    with pytest.raises(InputError, match=says):
        Program(name, inputs, outputs, TAPE)


def test_the_reference_takes_batches() -> None:
    program = Program("f", (("x", 1), ("y", 1)), (("r", (2, 1)),), TAPE)
    x = np.arange(6.0).reshape(2, 3, 1)
    (r,) = interpret(program, x, [10.0])
    assert r.shape == (2, 3, 2, 1)
    assert np.array_equal(r[..., 0, 0], x[..., 0] + 10)
    assert np.array_equal(r[..., 1, 0], x[..., 0] * 10)


def test_the_reference_checks_sizes() -> None:
    program = Program("f", (("x", 1), ("y", 1)), (("r", (2,)),), TAPE)
    with pytest.raises(InputError, match="last axis must be 1"):
        interpret(program, [1.0, 2.0], [1.0])
    with pytest.raises(InputError, match="takes 2 input groups, not 1"):
        interpret(program, [1.0])


def test_the_reference_divides_by_zero_without_a_warning() -> None:
    program = Program("f", (("x", 1),), (("r", ()),), Tape.of([1 / X], ["x"]))
    with np.errstate(all="raise"):
        assert interpret(program, [0.0])[0] == np.inf
