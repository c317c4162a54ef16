"""Numbers with derivatives: rules against derivatives by hand, and what is not known stays unknown."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nullbody import VerificationError
from nullbody.expr.parse import parse
from nullbody.mechanism import GROUND
from nullbody.verify.taylor import FUNCTIONS, Moving, Taylor, cosine, root, sine, tangent
from nullbody.verify.taylor_motion import BodyMotion, TaylorMotion, Variables
from tests.verify.mechanisms import loaded

T = Taylor(0.7, np.array([1.0]), np.array([0.0]))


def test_sums_and_products_have_the_derivatives_of_a_known_curve() -> None:
    """x(t) = sin(2 t) (3 - cos t) + t at t = 0.7."""
    x = sine(2 * T) * (3 - cosine(T)) + T
    s2, c2, s, c = math.sin(1.4), math.cos(1.4), math.sin(0.7), math.cos(0.7)
    assert x.value == pytest.approx(s2 * (3 - c) + 0.7, rel=1e-15)
    assert x.first[0] == pytest.approx(2 * c2 * (3 - c) + s2 * s + 1, rel=1e-15)
    assert x.second[0] == pytest.approx(-4 * s2 * (3 - c) + 4 * c2 * s + s2 * c, rel=1e-15)


@pytest.mark.parametrize(
    ("x", "value", "first", "second"),
    [
        (1 / T, 1 / 0.7, -1 / 0.49, 2 / 0.343),
        (T / 4 - 1, -0.825, 0.25, 0),
        (2 / (T * T), 2 / 0.49, -4 / 0.343, 12 / 0.2401),
        (root(T), 0.7**0.5, 0.5 * 0.7**-0.5, -0.25 * 0.7**-1.5),
        (tangent(T), math.tan(0.7), 1 / math.cos(0.7) ** 2, 2 * math.tan(0.7) / math.cos(0.7) ** 2),
        (parse("t^-3 - tan(t)*0", {"t": T}.get, functions=FUNCTIONS), 0.7**-3, -3 * 0.7**-4, 12 * 0.7**-5),
    ],
)
def test_quotients_and_roots(x, value, first, second) -> None:
    assert (x.value, x.first[0], x.second[0]) == pytest.approx((value, first, second), rel=1e-14)


def test_second_derivatives_are_mixed_ones_of_each_direction_and_the_motion() -> None:
    """x y^2 along dx, dy and the motion (2, 3)."""
    x = Taylor(5, np.array([1.0, 0, 2]), np.zeros(3))
    y = Taylor(7, np.array([0, 1.0, 3]), np.zeros(3))
    z = x * y * y
    assert z.first.tolist() == [49, 70, 2 * 49 + 3 * 70]
    assert z.second.tolist() == [3 * 14, 2 * 14 + 3 * 10, 2 * 2 * 3 * 14 + 9 * 10]


def test_matrices_follow_the_rules_of_their_entries() -> None:
    draw = np.random.default_rng(2)
    left, right = (Moving(draw.normal(size=(3, 3)), *draw.normal(size=(2, 4, 3, 3))) for _ in range(2))
    vector = Moving(draw.normal(size=3), *draw.normal(size=(2, 4, 3)))
    for product, factor in ((left @ right, right), (left @ vector, vector), (left @ right.value, right.value)):
        other = factor.tolist() if isinstance(factor, np.ndarray) else factor.entries()
        by_entries = Moving.of(np.array(left.entries(), dtype=object) @ np.array(other, dtype=object), 4)
        for part in ("value", "first", "second"):
            assert getattr(product, part) == pytest.approx(getattr(by_entries, part), abs=1e-14)


def test_places_without_a_derivative_are_named() -> None:
    with pytest.raises(VerificationError, match="square root of 0"):
        root(T - 0.7)
    with pytest.raises(VerificationError, match="square root of -1"):
        root(-1.0)
    with pytest.raises(VerificationError, match="divides by zero"):
        1 / (T - 0.7)


def test_velocity_knows_its_derivatives_and_no_others() -> None:
    """A point that turns with e3 = z and moves with x."""
    mechanism = loaded("Spring")
    size = len(mechanism.coordinates)
    draw = np.random.default_rng(0)
    q, q_dot = draw.normal(size=(2, size))
    variables = Variables.at(mechanism.coordinates, q, q_dot, 0.3)
    rotation = Moving.fixed(np.eye(3), variables.directions)
    position = Moving.of([variables.q["x"] * variables.q["b"], variables.q["y"], 0.0], variables.directions)
    motion = TaylorMotion(mechanism, mechanism.values(), variables, {"body": BodyMotion(rotation, position)})
    x, b = (mechanism.coordinates.index(name) for name in ("x", "b"))
    v = motion.velocity("body", [0.1, 0.2, 0.3])[0]
    assert v.value == pytest.approx(q_dot[x] * q[b] + q[x] * q_dot[b])
    assert v.first[[x, size + x]] == pytest.approx([q_dot[b], q[b]])
    assert v.first[-1] == pytest.approx(2 * q_dot[x] * q_dot[b])
    assert v.second[size + x] == pytest.approx(q_dot[b])
    assert np.isnan(v.second[[x, -1]]).all()
    assert motion.velocity(GROUND, [1, 2, 3]) == motion.spin(GROUND) == [0, 0, 0]
    assert motion.expression("t + x_dot").value == pytest.approx(0.3 + q_dot[x])
    assert motion.with_rates(2 * q_dot).velocity("body", [0, 0, 0])[0].value == pytest.approx(2 * v.value)
