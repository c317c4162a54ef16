"""The four-bars of the MBDE toolbox, and others."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import Trajectory, assemble, build, catalog, derive, simulate
from nullbody.typing import FloatArray
from tests.benchmarks_published.planar import Plant, turned
from tests.benchmarks_published.published import moved, reference


def points(found: Trajectory) -> dict[str, FloatArray]:
    """Crank angle, crank pin and rocker pin, and their velocities, in the names of the reference."""
    p, (crank, _, rocker), (w, _, r) = found.model.parameters, found.q.T, found.q_dot.T
    x1, y1 = p["crank"] * np.cos(crank), p["crank"] * np.sin(crank)
    x2, y2 = p["rocker"] * np.cos(rocker), p["rocker"] * np.sin(rocker)
    positions = {"theta1": crank, "x1": x1, "y1": y1, "x2": p["base"] + x2, "y2": y2}
    return positions | {"theta1_d": w, "x1_d": -y1 * w, "y1_d": x1 * w, "x2_d": -y2 * r, "y2_d": x2 * r}


@pytest.mark.parametrize(("motion", "digits"), [("ferrol", 3e-8), ("almeria", 3e-10)])
def test_the_published_motions(motion: str, digits: float) -> None:
    wanted = reference("four_bar", motion)
    found = moved("four_bar", motion, wanted["t"], rtol=1e-12)
    for name, values in points(found).items():
        np.testing.assert_allclose(values, wanted[name], rtol=0, atol=digits, err_msg=name)
    assert found.statistics.residual < 1e-13
    assert found.statistics.energy_drift < 1e-8


def test_the_tightest_tolerance_gives_nine_digits() -> None:
    wanted = reference("four_bar", "ferrol")
    found = moved("four_bar", "ferrol", wanted["t"], rtol=1e-13)
    for name, values in points(found).items():
        np.testing.assert_allclose(values, wanted[name], rtol=0, atol=2e-9, err_msg=name)


def test_other_bars() -> None:
    """Against three bodies with pins."""
    values = {"crank": 0.3, "coupler": 0.9, "rocker": 0.6, "base": 1.0, "m1": 3.0, "m2": 0.4, "m3": 1.3, "g": 9.0}
    t = np.linspace(0, 1.5, 7)
    found = moved("four_bar", "ferrol", t, values)
    p = found.model.parameters
    lengths = [p[name] for name in ("crank", "coupler", "rocker")]
    masses = [p[name] for name in ("m1", "m2", "m3")]

    def poses(q: FloatArray) -> FloatArray:
        angles = [q[0], q[0] + q[1], q[2]]
        origins = [np.zeros(2), turned(q[0], (lengths[0], 0)), np.array([p["base"], 0.0])]
        return np.concatenate(
            [[*(o + turned(a, (x / 2, 0))), a] for o, a, x in zip(origins, angles, lengths, strict=True)]
        )

    first, last = [(-x / 2, 0.0) for x in lengths], [(x / 2, 0.0) for x in lengths]
    plant = Plant(
        mass=masses,
        moment=[m * x**2 / 12 for m, x in zip(masses, lengths, strict=True)],
        pins=[
            (0, first[0], None, (0, 0)),
            (0, last[0], 1, first[1]),
            (1, last[1], 2, last[2]),
            (2, first[2], None, (p["base"], 0)),
        ],
        gravity=p["g"],
    )
    np.testing.assert_allclose([poses(q) for q in found.q], plant.motion(poses(found.q[0]), t), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "lengths",
    [(1, 1, 1, 1.5), (2, 0.5, 0.5, 2), (0.2, 3, 3, 0.5), (1.2, 1.4, 0.8, 2.5), (5, 8, 2, 10), (1, 0.2, 0.3, 1.3)],
)
def test_home_closes_for_all_bars_that_can_meet(lengths: tuple[float, ...]) -> None:
    model = build(derive(catalog.four_bar(**dict(zip(("crank", "coupler", "rocker", "base"), lengths, strict=True)))))
    assert np.abs(model.residual(np.array(list(model.mechanism.home_values(model.parameters).values())))).max() < 1e-14


def test_through_its_dead_points_with_the_crank_independent() -> None:
    """A triple rocker: the crank angle stops determining the rest, where coupler and rocker are in line."""
    model = build(derive(catalog.four_bar(crank=2.0, coupler=1.5, rocker=1.6, base=2.5, g=9.81), ("theta1",)))
    found = simulate(model, assemble(model, {"theta1": 0.8}), 5.0, rtol=1e-11, samples=501)
    assert found.statistics.switches > 0
    assert found.statistics.energy_drift < 1e-7
    assert found.statistics.residual < 1e-13
    reach = np.sum((np.array([2.5, 0]) - 2.0 * np.array([np.cos(found["theta1"]), np.sin(found["theta1"])]).T) ** 2, 1)
    assert np.sqrt(reach.max()) == pytest.approx(3.1, abs=2e-3)
