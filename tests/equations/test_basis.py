"""The basis in whose rates the dynamics are written: the same numbers in fewer operations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nullbody import MechanismBuilder, assemble, build
from nullbody.catalog import MODELS, n_four_bar, rolling_disc, stewart_platform, three_prs, three_rps
from nullbody.equations import Equations, derive
from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.mechanism import Mechanism, Placement, Rotation
from tests.mechanisms import four_bar
from tests.oracles.sample import evaluate

EPS = 2.2e-16
BASES: list[tuple[Callable[[], Mechanism], tuple[str, ...]]] = [
    (three_prs, ("alpha1", "alpha2", "alpha3")),
    (three_prs, ("y", "psi", "theta")),
    (three_prs, ("s1", "alpha2", "phi")),
    (three_rps, ("z", "psi", "theta")),
    (n_four_bar, ("theta1",)),
    (stewart_platform, ("x", "y", "z", "psi", "theta", "phi")),
    (rolling_disc, ("x", "y", "e1")),
]


def _values(eq: Equations, seed: int) -> dict[str, float]:
    """Symbols at random, q near the home: the equations hold off the manifold too."""
    rng = np.random.default_rng(seed)
    rates = [*eq.groups["v"], *eq.groups["u"], *eq.groups["v_dot"], *eq.groups["t"]]
    home = eq.mechanism.home_values(eq.mechanism.values())
    q = {name: value + rng.uniform(0.05, 0.3) for name, value in home.items()}
    return q | {name: rng.uniform(0.2, 1.2) for name in rates} | eq.mechanism.values()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("make", "basis"), BASES)
def test_every_basis_gives_the_same_motion(make: Callable[[], Mechanism], basis: tuple[str, ...], seed: int) -> None:
    mechanism = make()
    plain = derive(mechanism, basis=derive(mechanism).independent)
    other = derive(mechanism, plain.independent, basis=basis)
    assert (plain.basis, other.basis) == (plain.independent, basis)
    values = _values(plain, seed)
    for routine, names in (
        ("forward_dynamics", ("q_ddot", "q_dot", "delta", "power")),
        ("inverse_dynamics", ("Qr", "u", "Br", "delta")),
    ):
        one, two = (evaluate(eq.routines[routine].outputs, values) for eq in (plain, other))
        digits = EPS * 1e3 * np.sqrt(max(one["spread"], two["spread"])) * max(one["loss"], two["loss"])
        for name in names:
            size = np.abs(one[name]).max(initial=0.0)
            np.testing.assert_allclose(two[name], one[name], rtol=0, atol=max(digits, 1e-12) * size, err_msg=name)
        assert two["spread"] >= one["spread"] * (1 - 1e-9)  # a bound: nothing is let pass that v itself would refuse


@pytest.mark.parametrize("name", list(MODELS))
def test_the_chosen_basis_costs_least_and_is_regular_around_the_home(name: str) -> None:
    chosen = derive(MODELS[name]())
    plain = derive(chosen.mechanism, chosen.independent, basis=chosen.independent)
    costs = [eq.routine_operations("forward_dynamics").arithmetic for eq in (chosen, plain)]
    assert costs[0] <= costs[1]
    assert (costs[0] < costs[1]) == (chosen.basis != chosen.independent)


def test_the_robots_hinges_are_its_basis() -> None:
    """Platform coordinates cost less still, but links that point straight up are singular for them, as at the home."""
    assert derive(three_prs()).basis == ("alpha1", "alpha2", "alpha3")
    assert derive(three_rps()).basis == ("z", "psi", "theta")


def test_where_the_basis_is_singular_other_kernels_answer() -> None:
    mechanism = three_prs()
    model = build(derive(mechanism, basis=("y", "psi", "theta")))
    plain = build(derive(mechanism, basis=("s1", "s2", "s3")))
    assert model.plain is not model
    assert plain.plain is plain
    home = assemble(model, {}, v=(0.3, -0.2, 0.1))
    assert home["alpha1"] == pytest.approx(np.pi / 2)
    inputs = np.array([1.0, 2.0, -1.0])
    np.testing.assert_allclose(model.forward_dynamics(home, inputs), plain.forward_dynamics(home, inputs), rtol=1e-12)
    wanted = np.array([0.5, 0.1, 0.2])
    np.testing.assert_allclose(model.inverse_dynamics(home, wanted), plain.inverse_dynamics(home, wanted), rtol=1e-12)


def test_a_state_that_is_singular_in_itself_is_refused_in_any_basis() -> None:
    model = build(derive(three_prs()))
    v = np.zeros(3)

    def delta(q: np.ndarray) -> float:
        return float(model.evaluate("kinematics", q, v)[3])

    rng = np.random.default_rng(2)
    one, two = assemble(model, {}).q, rng.uniform(-1, 1, 12)
    while delta(one) * delta(two) > 0:
        two = rng.uniform(-1, 1, 12)
    for _ in range(200):
        middle = (one + two) / 2
        one, two = (middle, two) if delta(middle) * delta(two) < 0 else (one, middle)
    assert model.basis != model.independent
    with pytest.raises(SingularityError, match="the independent coordinates s1, s2, s3 are singular here"):
        model.forward_dynamics(model.trusted_state(one, v))


def _bar_on_cart() -> Mechanism:
    """A four-bar on a cart; a torque on its rocker does nothing where crank and coupler are in line."""
    b = MechanismBuilder("bar_on_cart", gravity=(0, -9.81, 0), own="planar")
    b.body("cart", mass=2)
    b.rod("crank", 0.3, 0.2)
    b.rod("coupler", 0.7, 0.5)
    b.rod("rocker", 0.6, 0.4)
    b.prismatic("x", "ground", "cart", at=Placement(rotations=(Rotation("z", degrees=30),)), axis="x")
    b.revolute("q1", "cart", "crank")
    b.revolute("q3", "cart", "rocker", at=(0.6, 0, 0))
    b.revolute("pin1", "crank", "coupler", at=(0.2, 0, 0), coordinates="body")
    b.revolute("pin2", "coupler", "rocker", at=(0.5, 0, 0), on=(0.4, 0, 0), loop=True)
    b.actuator("push", "x")
    b.actuator("torque", "q3")
    b.home(q1=1.3, q3=1.8, coupler_x=0.05, coupler_y=0.2, coupler_alpha=0.8)
    return b.build()


def test_generalized_forces_do_not_suffer_where_the_inputs_are_singular() -> None:
    """push has the value of the force along x, but its form divides by |Br|: 0/0 in the dead centre."""
    model = build(derive(_bar_on_cart(), ("x", "q1"), basis=("coupler_x", "coupler_y")))
    dead = np.arccos((0.7**2 + 0.6**2 - 0.4**2) / (2 * 0.7 * 0.6))
    state = assemble(model, {"x": 0.1, "q1": dead}, v=(1.0, 2.0))
    found, expected = (m.generalized_forces(state, (1.0, 2.0)) for m in (model, model.plain))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("distance", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_beside_a_singularity_of_a_single_coordinate_of_the_basis(distance: float) -> None:
    """One degree of freedom: |N| and |P| grow alike, and their quotient shows nothing."""
    model = build(derive(four_bar(), ("q1",), basis=("q3",)))
    dead = np.arccos((0.7**2 + 0.6**2 - 0.4**2) / (2 * 0.7 * 0.6))
    state = assemble(model, {"q1": dead + distance}, v=(1.0,))
    found, expected = (m.forward_dynamics(state) for m in (model, model.plain))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
    found, expected = (m.generalized_forces(state, (1.0,)) for m in (model, model.plain))
    np.testing.assert_allclose(found, expected, rtol=1e-8)


@pytest.mark.parametrize("seed", [6, 8, 10])
def test_inverse_dynamics_beside_a_singularity_of_the_basis(seed: int) -> None:
    """Mr goes through the rates of the basis twice: its digits are lost with the square of the condition of P."""
    model = build(derive(three_prs()))
    basis = model.in_chart(model.basis)
    v, v_dot = np.array([0.3, -0.2, 0.4]), np.array([1.0, -2.0, 0.5])

    def delta(q: np.ndarray) -> float:
        return float(basis.evaluate("kinematics", q, v)[3])

    rng = np.random.default_rng(seed)
    one, two = assemble(model, {}).q + rng.uniform(-0.3, 0.3, 12), rng.uniform(-1, 1, 12)
    while delta(one) * delta(two) > 0:
        two = rng.uniform(-1, 1, 12)
    for _ in range(60):
        middle = (one + two) / 2
        one, two = (middle, two) if delta(middle) * delta(two) < 0 else (one, middle)
    direction = rng.uniform(-1, 1, 12)
    for distance in (1e-7, 1e-6, 1e-5, 1e-4, 1e-3):
        state = model.trusted_state(one + distance * direction, v)
        found, expected = (m.generalized_forces(state, v_dot) for m in (model, model.plain))
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_a_basis_that_is_none_is_refused_by_name() -> None:
    with pytest.raises(UnknownName, match="no coordinate 'alpha'"):
        derive(three_prs(), basis=("alpha", "psi", "theta"))
    with pytest.raises(InputError, match=r"a basis of 'three_prs' has 3 coordinates, not \['y', 'psi'\]"):
        derive(three_prs(), basis=("y", "psi"))
    with pytest.raises(SingularityError, match="cannot be the independent coordinates"):
        derive(three_prs(), basis=("x", "y", "theta"))
