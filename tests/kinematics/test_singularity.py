"""Singularity measures where the answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import assemble, build, derive, inverse_kinematics, simulate, singularity
from tests.mechanisms import four_bar
from tests.robot import HOME, SLIDES, robot, tilted, upright


def test_vertical_links_are_an_inverse_singularity_only() -> None:
    found = singularity(robot(), upright(robot()))
    assert found.inverse < 1e-14
    assert found.forward > 0.1
    assert found.constraint > 0.1
    assert found.delta == pytest.approx(0.00675, rel=1e-12)
    assert found.subspace_error < 1e-14


def test_flat_links_are_a_forward_singularity_only() -> None:
    model = robot()
    q = np.zeros(12)
    q[9:] = 0.1
    found = singularity(model, model.state(q))
    assert found.forward < 1e-14
    assert found.inverse > 0.1
    assert found.delta == pytest.approx(0.0, abs=1e-17)
    assert found.subspace_error > 1e-3


def test_measures_fall_steadily_towards_the_flat_links() -> None:
    model = robot()
    heights = (0.3, 0.1, 0.03, 0.01, 0.003)
    found = [singularity(model, inverse_kinematics(model, {"y": y, "psi": 0.0, "phi": 0.0})) for y in heights]
    forward = [each.forward for each in found]
    assert forward == sorted(forward, reverse=True)
    assert forward[-1] < 0.02 * forward[0]
    errors = [each.subspace_error for each in found]
    assert errors == sorted(errors)


def test_free_fall_ends_at_a_forward_singularity() -> None:
    model = robot()
    fall = simulate(model, assemble(model, HOME, v=(0.1, 0.1, 0.1)), 2.0, throw=False, switch=False)
    begin, end = singularity(model, fall.state(0.0)), singularity(model, fall.state(fall.t[-1]))
    assert end.forward < 1e-4 * begin.forward
    assert end.constraint > 0.05
    assert abs(end.delta) < 1e-4 * begin.delta


def test_measures_do_not_depend_on_the_unit_of_length() -> None:
    model, scale = robot(), 1000.0
    other = model.replace(a=0.8 * scale, b=0.2 * scale, l=0.5 * scale)
    lengths = np.array([model.mechanism.units[name] == "m" for name in model.coordinates])
    for x in tilted(model, 4):
        guess = other.trusted_state(np.where(lengths, scale * x.q, x.q), x.v.copy())
        y = assemble(other, {name: guess[name] for name in SLIDES}, guess=guess)
        assert singularity(model, x).inverse == pytest.approx(singularity(other, y).inverse, rel=1e-9)


def test_without_end_effector_there_is_no_inverse_measure() -> None:
    model = build(derive(four_bar(), ("q1",)))
    found = singularity(model, assemble(model, {"q1": 1.3}))
    assert np.isnan(found.inverse)
    assert 0.1 < found.forward <= 1.0
