"""Kernels with memory of their own: the same numbers, no new arrays."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from nullbody import build, derive
from nullbody.catalog import n_four_bar, three_prs
from nullbody.errors import InputError, UnknownName
from nullbody.expr import Graph, Tape, sin
from nullbody.kernels import Kernel, Program, compile_programs


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    g = Graph()
    x, y, p = g.symbol("x"), g.symbol("y"), g.symbol("p")
    tape = Tape.of([sin(x) * p, x + y, x * y - p, y * y], ("x", "y", "p"))
    program = Program("pair", (("x", 1), ("y", 1), ("p", 1)), (("f", ()), ("g", (3,))), tape)
    return compile_programs([program]).kernels["pair"]


def test_results_are_those_of_the_kernel_and_stay_where_they_are(kernel: Kernel) -> None:
    bound = kernel.bound()
    bound.inputs["p"][:] = 2.0
    f, g = bound([0.5], [3.0])
    expected = kernel([0.5], [3.0], [2.0])
    assert (f, *g) == (expected[0], *expected[1])
    assert f is bound.outputs["f"]
    assert g is bound.outputs["g"]
    bound.inputs["y"][:] = 4.0
    assert bound()[1] is g
    np.testing.assert_array_equal(g, kernel([0.5], [4.0], [2.0])[1])


def test_two_bound_kernels_share_nothing(kernel: Kernel) -> None:
    one, two = kernel.bound(), kernel.bound()
    first = one([1.0], [2.0], [3.0])[1].copy()
    two([4.0], [5.0], [6.0])
    np.testing.assert_array_equal(one.outputs["g"], first)


def test_calls_leave_nothing_behind(kernel: Kernel) -> None:
    bound = kernel.bound()
    x, y, p = (np.array([value]) for value in (0.1, 0.2, 0.3))
    bound(x, y, p)
    before = sys.getallocatedblocks()
    for _ in range(1000):
        bound(x, y, p)
    assert abs(sys.getallocatedblocks() - before) < 50


def test_inputs_that_do_not_fit_are_named(kernel: Kernel) -> None:
    bound = kernel.bound()
    with pytest.raises(InputError, match=r"kernel pair\(.*\): input 'x' has shape \(2,\), not \(1,\)"):
        bound([1.0, 2.0])
    with pytest.raises(InputError, match="input 'y' has shape"):
        bound([1.0], np.zeros((1, 1)))
    with pytest.raises(InputError, match=r"holds .*, not real numbers"):
        bound(["one"])
    with pytest.raises(InputError, match="has shape"):
        bound(1.0)
    with pytest.raises(InputError, match="takes 3 input groups, not 4"):
        bound([1.0], [1.0], [1.0], [1.0])
    with pytest.raises(TypeError):
        bound.inputs["x"] = np.zeros(1)  # type: ignore[index]


def test_one_number_is_never_spread_over_a_group() -> None:
    model = build(derive(three_prs()))
    bound, q = model.bound("forward_dynamics"), np.linspace(0.1, 1.2, 12)
    for wrong in (0.3, [0.3], np.array([0.3]), np.array(0.3), np.zeros((3, 1))):
        with pytest.raises(InputError, match="input 'v' has shape"):
            bound(q, wrong)
    found = [
        bound(q, v, u)[0].copy() for v, u in (([1, 2, 3], np.ones(3)), (np.array([1, 2, 3], np.float32), [1, 1, 1]))
    ]
    reversed_q = np.ascontiguousarray(q[::-1])[::-1]  # strides do not matter
    np.testing.assert_array_equal(found[0], bound(reversed_q, np.array([1.0, 2.0, 3.0]), np.ones(3))[0])
    np.testing.assert_array_equal(found[0], found[1])


def test_a_models_kernel_has_its_parameters() -> None:
    model = build(derive(n_four_bar())).replace(g=3.0)
    bound = model.bound("forward_dynamics")
    q, v = np.full(len(model.coordinates), 0.3), np.full(len(model.independent), 0.7)
    found = bound(q, v, np.zeros(len(model.inputs)))
    expected = model.evaluate("forward_dynamics", q, v, np.zeros(len(model.inputs)))
    for one, two in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, two)
    with pytest.raises(UnknownName, match="no routine 'forward'"):
        model.bound("forward")
