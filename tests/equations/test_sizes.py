"""Sizes of expressions at configurations, and pivots that vanish where the loops are closed."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import catalog, derive
from nullbody.equations.sizes import Sizes, sizes_at
from nullbody.expr import Expr, Graph, Tape, cos, sin, sqrt
from nullbody.nullspace.pivots import Pivot


def test_values_are_those_of_the_tape() -> None:
    graph, names = Graph(), ("x", "y", "p")
    x, y, p = (graph.symbol(name) for name in names)
    entries = [x * sin(y) - p / x, sqrt(x * x + 1) * cos(y) - 2, -x, graph.constant(-3) + 0 * x]
    points = [np.array([0.3, 1.1]), np.array([-0.7, 0.2])]
    sizes = sizes_at(("x", "y"), points, {"p": 0.5})
    assert sizes is not None
    for entry in entries:
        expected = [abs(Tape.of([entry], names).run([*point, 0.5])[0]) for point in points]
        np.testing.assert_allclose(sizes(entry), expected, rtol=1e-15)
    np.testing.assert_array_equal(sizes(-2), [2, 2])


def test_a_symbol_without_a_value_is_not_a_number() -> None:
    graph = Graph()
    x, v = graph.symbol("x"), graph.symbol("v")
    sizes = Sizes({"x": np.array([1.0])})
    assert np.isnan(sizes(x * v)).all()
    assert sizes(x).tolist() == [1.0]
    assert sizes_at(("x",), [], {}) is None


@pytest.mark.parametrize("independent", [None, ("x", "y", "z"), ("alpha1", "alpha2", "z")])
def test_no_pivot_of_the_delta_robot_vanishes_on_the_manifold(independent: tuple[str, ...] | None) -> None:
    """Entries that are zero for every platform that is not turned, but not identically, are no pivots."""
    robot = catalog.delta()
    equations = derive(robot, independent)
    values = robot.values()
    home = robot.home_values(values)
    names = [*home, *values]
    pivots = [stage for stage in equations.null_space._factors.stages if isinstance(stage, Pivot)]
    expressions = [pivot.value for pivot in pivots if isinstance(pivot.value, Expr)]
    assert len(expressions) > 6
    found = np.array(Tape.of(expressions, names).run([*home.values(), *values.values()]))
    assert np.abs(found).min() > 1e-3
