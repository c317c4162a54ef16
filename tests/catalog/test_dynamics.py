"""Dynamics of robots and linkages: mobility, both directions, energy, and independent engines."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import assemble, build, catalog, derive, simulate, verify
from nullbody.report.skeleton import skeleton
from tests.catalog.robot import NAMES, model, states

ENGINES = ("multipliers", "mujoco", "pinocchio")


@pytest.mark.parametrize("name", catalog.MODELS)
def test_mobility(name: str) -> None:
    entry, mechanism = catalog.describe(name), catalog.mechanism(name)
    equations = derive(mechanism)
    assert len(equations.independent) == entry.degrees_of_freedom
    if entry.group != "benchmark":
        assert equations.independent == mechanism.actuated
        assert len(equations.labels) == len(equations.coordinates) - entry.degrees_of_freedom
        assert all(label.endswith(" z") for label in equations.redundant)  # across the plane
    assert not set(entry.task) - set(mechanism.coordinates)
    assert len(entry.task) in (0, entry.degrees_of_freedom)


@pytest.mark.parametrize("name", NAMES)
def test_forward_dynamics_undoes_inverse_dynamics(name: str) -> None:
    found, draw = model(name), np.random.default_rng(4)
    places = [found.coordinates.index(c) for c in found.independent]
    for state in states(name):
        wanted = draw.normal(size=len(places))
        reached = found.forward_dynamics(state, found.inverse_dynamics(state, wanted))[places]
        np.testing.assert_allclose(reached, wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_free_motion_conserves_energy(name: str) -> None:
    """From home, pushed a little, for a fifth of a second; the robots fall."""
    found = model(name)
    start = assemble(found, {}, v=np.full(len(found.independent), 0.1))
    motion = simulate(found, start, 0.2, rtol=1e-10, atol=1e-11)
    assert motion.outcome.ok
    assert motion.statistics.energy_drift < 1e-8 * max(1.0, np.abs(found.energy(start)).max())
    assert motion.statistics.residual < 1e-13


@pytest.mark.parametrize("name", NAMES)
def test_independent_engines_agree(name: str) -> None:
    found = verify.compare(model(name), engines=ENGINES, states=10)
    assert found.ok, str(found)


def test_forearms_of_the_delta_robot_move_as_two_parallel_rods() -> None:
    """A thin rod whose ends have the velocities v, w has m (v.v + v.w + w.w)/6, wherever beside the other it lies."""
    found = model("delta")
    p = found.parameters
    for state in states("delta"):
        rates = dict(zip(found.coordinates, found.velocity(state), strict=True))
        platform = np.array([rates["x"], rates["y"], rates["z"]])
        kinetic = p["M"] * platform @ platform / 2
        for i, degrees in enumerate((0, 120, -120), 1):
            alpha, speed, turn = state[f"alpha{i}"], rates[f"alpha{i}"], np.radians(degrees)
            out = np.array([np.cos(turn), np.sin(turn), 0.0])
            elbow = -p["la"] * speed * (np.sin(alpha) * out + np.cos(alpha) * np.array([0, 0, 1]))
            kinetic += p["ma"] * elbow @ elbow / 6
            kinetic += 2 * (p["mf"] / 2) * (elbow @ elbow + elbow @ platform + platform @ platform) / 6
        assert found.energy(state).kinetic == pytest.approx(kinetic, rel=1e-12)
        assert max(abs(state[c]) for c in ("psi", "theta", "phi")) < 1e-14


def test_start_of_the_spatial_slider_crank_is_the_published_one() -> None:
    """Velocities at theta = 0, theta' = 6 rad/s, of the EXUDYN model of the IFToMM benchmark (10 digits).

    But for the rod's turn about itself: there its universal joint has another axis on the rod.
    """
    found = model("spatial_slider_crank")
    start = assemble(found, {"theta": 0.0}, v=[6.0])
    rates = dict(zip(found.coordinates, found.velocity(start), strict=True))
    assert (start["s"], rates["s"]) == (pytest.approx(0.2, abs=1e-15), pytest.approx(0.24, abs=1e-14))
    across = np.array([0.0, np.cos(start["alpha"]), np.sin(start["alpha"])])
    spin = rates["alpha"] * np.eye(3)[0] + rates["beta"] * across
    rod = np.array([2.0, -1.0, -2.0]) / 3  # from the crank's pin to the slider
    published = np.array([1.6941176470530785, -0.8470588235366621, 0.705882352947701])
    np.testing.assert_allclose(np.cross(spin, rod), np.cross(published, rod), rtol=0, atol=1e-10)
    centre = np.cross(spin, -0.15 * rod) + np.array([rates["s"], 0, 0])
    np.testing.assert_allclose(centre, [0.12, -0.24, 0.0], rtol=0, atol=1e-14)


def test_coupler_with_two_balls_would_have_an_idle_motion() -> None:
    """Turned over (half a turn about itself) the coupler of the RSSR moves everything else in the same way."""
    found = model("rssr")
    for state in states("rssr")[:4]:
        over = {"theta": state["theta"], "psi": state["psi"], "alpha": state["alpha"] + np.pi}
        other = assemble(found, {"theta": state["theta"]}, v=state.v, guess={**over, "beta": np.pi - state["beta"]})
        assert other["alpha"] == pytest.approx(over["alpha"])
        one, two = (found.forward_dynamics(x, [0.3]) for x in (state, other))
        np.testing.assert_allclose(one[[0, 3]], two[[0, 3]], rtol=1e-9)


def test_wireframes_of_loops_are_closed() -> None:
    """The numbers that pictures are drawn from, against the model's own closures."""
    for name in NAMES:
        given = skeleton(model(name).mechanism, model(name).parameters, states(name)[-1].positions)
        for loop in given.mechanism.loops:
            ends = given.place(loop.parent, loop.at).position, given.place(loop.child, loop.on).position
            np.testing.assert_allclose(*ends, rtol=0, atol=1e-13)


def test_parameters_change_without_a_new_derivation() -> None:
    longer = build(derive(catalog.delta()), {"la": 0.3})
    other = build(derive(catalog.delta(la=0.3)))
    known = {"alpha1": 0.2, "alpha2": 0.4, "alpha3": 0.1}
    np.testing.assert_allclose(assemble(longer, known).q, assemble(other, known).q, rtol=0, atol=1e-12)
