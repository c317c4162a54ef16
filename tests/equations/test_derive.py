from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from nullbody.catalog import three_prs
from nullbody.equations import Equations, derive
from nullbody.errors import InputError, MechanismError, SingularityError, UnknownName
from nullbody.mechanism import Actuator, Body, Mechanism, Placement, Prismatic, Revolute, Spherical
from tests.mechanisms import four_bar, slider_crank, two_bodies
from tests.oracles.sample import evaluate


def cart(**changes: Any) -> Mechanism:
    """One body on a rail."""
    parts: dict[str, Any] = {
        "name": "cart",
        "bodies": (Body("cart", 2),),
        "joints": (Prismatic("slide", "ground", "cart", ("x",), axis="x"),),
    }
    return Mechanism(**{**parts, **changes})


def _values(eq: Equations, seed: int = 0) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    values = {name: rng.uniform(-1, 1) for name in eq.graph.symbols}
    return values | eq.mechanism.values()


@pytest.mark.parametrize("mechanism", [four_bar, slider_crank, two_bodies])
def test_null_space_and_reduction_of_other_mechanisms(mechanism: Callable[[], Mechanism]) -> None:
    eq = derive(mechanism())
    found = evaluate(eq.outputs, _values(eq))
    N, M, gamma = found["N"], found["M"], found["gamma"]
    if eq.labels:
        np.testing.assert_allclose(found["A"] @ N, 0, atol=1e-12 * np.abs(N).max())
        np.testing.assert_allclose(found["A"] @ gamma, -found["c"], rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(found["N_scaled"], found["delta"] * N, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(found["Mr"], N.T @ M @ N, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(found["hr"], N.T @ (found["h"] + M @ gamma), rtol=1e-10, atol=1e-12)
    assert np.linalg.eigvalsh(found["Mr"]).min() > 0


@pytest.mark.parametrize("mechanism", [four_bar, slider_crank, two_bodies])
def test_h_follows_from_the_energies_of_other_mechanisms(mechanism: Callable[[], Mechanism]) -> None:
    """h = d/dt(dT/dq') - dT/dq + dU/dq, by central differences of T and U."""
    eq = derive(mechanism())
    values, step = _values(eq, 3), 1e-4
    energies = {"T": eq["T"], "U": eq["U"]}

    def lagrangian(at: dict[str, float]) -> float:
        found = evaluate(energies, at)
        return float(found["T"] - found["U"])

    def slope(function: Callable[[dict[str, float]], float], at: dict[str, float], name: str) -> float:
        return (function(at | {name: at[name] + step}) - function(at | {name: at[name] - step})) / (2 * step)

    def momentum(at: dict[str, float], name: str) -> float:
        return slope(lagrangian, at, f"{name}_dot")

    def later(by: float) -> dict[str, float]:
        return values | {name: values[name] + by * values[f"{name}_dot"] for name in eq.coordinates}

    for name, h in zip(eq.coordinates, evaluate({"h": eq["h"]}, values)["h"], strict=True):
        rate = (momentum(later(step), name) - momentum(later(-step), name)) / (2 * step)
        assert h == pytest.approx(rate - slope(lagrangian, values, name), abs=2e-5)


def test_equations_that_repeat_others_are_reported_by_label() -> None:
    eq = derive(four_bar())
    assert eq.labels == ("pin x", "pin y")
    assert eq.redundant == ("pin z",)
    assert "z repeats other equations" in str(eq)


def test_a_loop_closed_twice_is_redundant() -> None:
    twice = Spherical("again", "coupler", "rocker", at=Placement(("b", 0, 0)), on=Placement(("c", 0, 0)))
    made = four_bar()
    eq = derive(Mechanism(**{**vars(made), "loops": (*made.loops, twice)}))
    assert eq.redundant == ("pin z", "again x", "again y", "again z")
    assert eq.independent == derive(made).independent


def test_the_default_choice_is_the_actuated_coordinates() -> None:
    assert derive(three_prs()).independent == ("s1", "s2", "s3")
    assert derive(four_bar()).independent == ("q1",)
    assert derive(slider_crank()).independent == ("s",)
    assert derive(two_bodies()).independent[0] == "swing"


def test_any_regular_choice_gives_the_same_motion() -> None:
    for name in ("q1", "q2", "q3"):
        eq = derive(four_bar(), [name])
        found = evaluate(eq.outputs, _values(eq, 1))
        null = np.linalg.svd(found["A"])[2][2:].T
        assert np.abs(found["N"] - null @ (null.T @ found["N"])).max() < 1e-12 * np.abs(found["N"]).max()


@pytest.mark.parametrize("independent", ["q1", ["q1"], ("q1",), iter(["q1"])])
def test_one_name_or_any_list_of_names(independent: Any) -> None:
    assert derive(four_bar(), independent).independent == ("q1",)


@pytest.mark.parametrize(
    ("independent", "error", "message"),
    [
        (("s1", "s2", "S3"), UnknownName, "no coordinate 'S3'; did you mean 's"),
        (("s1", "s2", "alpha"), UnknownName, "did you mean 'alpha"),
        ("s1, s2, s3", UnknownName, "no coordinate 's1, s2, s3'"),
        ("s1", InputError, r"3 degrees of freedom: name 3 coordinates, not \['s1'\]"),
        ((), InputError, "name 3 coordinates"),
        (("s1", "s2", "s3", "y"), InputError, "name 3 coordinates"),
        (("s1", "s2", "s2"), InputError, "name 3 coordinates"),
        ((9, 10, 11), UnknownName, "no coordinate 9"),
        (3, InputError, "list of coordinate names, not 3"),
        (("psi", "theta", "phi"), SingularityError, "would do"),
    ],
)
def test_bad_choices(independent: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        derive(three_prs(), independent)


def test_an_open_chain_has_n_equal_to_the_identity() -> None:
    eq = derive(two_bodies())
    found = evaluate(eq.outputs, _values(eq))
    order = [eq.coordinates.index(name) for name in eq.independent]
    np.testing.assert_array_equal(found["N"][order], np.eye(8))
    assert (eq.labels, eq["Phi"], float(found["delta"])) == ((), (), 1.0)


def test_a_mechanism_that_cannot_move() -> None:
    eq = derive(cart(loops=(Spherical("stop", "cart", "ground", on=Placement((1, 0, 0))),)))
    assert (eq.independent, eq["N"], eq["Mr"]) == ((), ((),), ())


def test_two_inputs_on_one_coordinate_add_up() -> None:
    eq = derive(cart(actuators=(Actuator("F", "x"), Actuator("G", "x"))))
    F, G = eq.graph.symbol("F"), eq.graph.symbol("G")
    assert (eq.independent, eq["Q"][0], eq["Br"]) == (("x",), F + G, ((1, 1),))
    assert eq.routines["forward_dynamics"].outputs["q_ddot"][0] == (F + G) / 2


def test_a_motion_without_mass_is_refused() -> None:
    with pytest.raises(MechanismError, match="some motion moves no mass"):
        derive(cart(bodies=(Body("cart"),)))


def test_a_pendulum_by_hand() -> None:
    """m l^2 alpha'' = -m g l sin(alpha): point mass hanging along -y, turning about z."""
    pendulum = Mechanism(
        name="pendulum",
        bodies=(Body("bob", 0.5, (0, -2, 0)),),
        joints=(Revolute("pivot", "ground", "bob", ("alpha",), axis="z"),),
        gravity=(0, -10, 0),
    )
    eq = derive(pendulum)
    values = {"alpha": 0.4, "alpha_dot": 1.5}
    found = evaluate({name: eq[name] for name in ("Mr", "hr", "T", "U")}, values)
    expected = {"Mr": 2.0, "hr": 10 * np.sin(0.4), "T": 0.5 * 2 * 1.5**2, "U": -10 * np.cos(0.4)}
    assert {name: value.item() for name, value in found.items()} == pytest.approx(expected, rel=1e-15)
