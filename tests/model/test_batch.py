"""Batches against the model for one state, for mechanisms of every kind."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from nullbody import Mechanism, MechanismBuilder, Model, assemble, build, catalog, derive
from nullbody.errors import InputError, ParameterError, SingularityError, UnknownName
from nullbody.model import batch as batch_module
from nullbody.model.batch_assembly import Assembled
from nullbody.tolerances import REGULAR_DOUBT
from tests.robot import robot

KINDS = ("three_prs", "four_bar", "stewart_platform", "rolling_disc", "driven", "andrews")
TIME = 0.3
SIZES = (0, 1, 7, 8, 9, 1000)


@cache
def model(name: str) -> Model:
    """A mechanism of the catalog, or one that is driven in time; the disc rolls."""
    if name == "driven":
        return build(derive(_driven()))
    return robot() if name == "three_prs" else build(derive(getattr(catalog, name)()))


def _driven() -> Mechanism:
    """A four-bar whose ground pivot is moved in time."""
    b = MechanismBuilder("driven", gravity=(0, -9.81, 0))
    for name, length in (("a", TIME), ("b", 0.8), ("c", 0.6)):
        b.rod(name, mass=length, length=length, axis="x")
    b.box("base", mass=1.0, size=(0.1, 0.1, 0.1))
    b.prismatic("rail", "ground", "base", axis="x", at=(0.9, 0, 0))
    b.revolute("A", "ground", "a")
    b.revolute("B", "a", "b", at=(0.3, 0, 0))
    b.revolute("C", "base", "c")
    b.revolute("D", "b", "c", at=(0.8, 0, 0), on=(0.6, 0, 0))
    b.home(A=1.2, B=-0.8, C=1.7)
    b.driver("shaker", "rail", "0.05*sin(4*t)")
    b.actuator("motor", "A")
    return b.build()


@cache
def states(name: str, count: int = 9, seed: int = 0) -> tuple[np.ndarray, ...]:
    """(q, v, u, v_dot), closed, near the home."""
    made, rng = model(name), np.random.default_rng(seed)
    near = {"s1": 0.6, "s2": 0.6, "s3": 0.6} if name == "three_prs" else {}
    q = np.tile(assemble(made, near, t=TIME).q, (count, 1))
    q[:, made.independent_columns] += rng.uniform(-0.02, 0.02, (count, len(made.independent)))
    closed = made.batch.assemble(q, t=TIME)
    assert closed.closed.all()
    nv = len(made.independent)
    return (
        closed.q,
        rng.normal(size=(count, nv)),
        rng.normal(size=(count, len(made.inputs))),
        rng.normal(size=(count, nv)),
    )


def _close(found: np.ndarray, wanted: np.ndarray) -> None:
    """Equal to 1e-13 of the largest entry of the state."""
    size = np.abs(wanted).reshape(len(wanted), -1).max(axis=1, initial=1e-300)
    error = np.abs(found - wanted).reshape(len(wanted), -1).max(axis=1, initial=0.0)
    assert found.shape == wanted.shape
    assert (error <= 1e-13 * size).all(), (error / size).max()


@pytest.mark.parametrize("name", KINDS)
def test_every_routine_gives_what_the_model_gives(name: str) -> None:
    made, (q, v, u, v_dot) = model(name), states(name)
    one = [made.trusted_state(a.copy(), b.copy(), TIME) for a, b in zip(q, v, strict=True)]
    batch = made.batch
    _close(
        batch.forward_dynamics(q, v, u, t=TIME),
        np.array([made.forward_dynamics(x, w) for x, w in zip(one, u, strict=True)]),
    )
    _close(
        batch.generalized_forces(q, v, v_dot, t=TIME),
        np.array([made.generalized_forces(x, w) for x, w in zip(one, v_dot, strict=True)]),
    )
    N, gamma, delta = batch.null_space(q, v, t=TIME)
    spaces = [made.null_space(x) for x in one]
    _close(N, np.array([s.N for s in spaces]))
    _close(gamma, np.array([s.gamma for s in spaces]))
    _close(delta, np.array([s.delta for s in spaces]))
    _close(batch.velocity(q, v, t=TIME), np.array([made.velocity(x) for x in one]))
    _close(np.stack(batch.energy(q, v, t=TIME), axis=1), np.array([made.energy(x) for x in one]))
    gaps = np.array([made.residual(row, TIME) for row in q])
    assert np.abs(batch.residual(q, t=TIME) - gaps).max(initial=0.0) < 1e-15


@pytest.mark.parametrize("name", ["three_prs", "stewart_platform", "five_bar"])
def test_inverse_dynamics_gives_what_the_model_gives(name: str) -> None:
    made, (q, v, _, v_dot) = model(name), states(name)
    found = made.batch.inverse_dynamics(q, v, v_dot)
    one = [made.trusted_state(a.copy(), b.copy()) for a, b in zip(q, v, strict=True)]
    _close(found, np.array([made.inverse_dynamics(x, w) for x, w in zip(one, v_dot, strict=True)]))
    again = made.batch.forward_dynamics(q, v, found)[:, made.independent_columns]
    np.testing.assert_allclose(again, v_dot, rtol=0, atol=1e-9)


def test_inputs_that_are_no_independent_coordinates_and_more_inputs_than_needed() -> None:
    passive = build(derive(catalog.three_rrr()))
    chart = passive.in_chart([c for c in passive.coordinates if c not in passive.independent][:3])
    home = assemble(chart, {})
    q = np.tile(home.q, (5, 1))
    v, v_dot = np.random.default_rng(0).normal(size=(2, 5, 3)) * 0.1
    found = chart.batch.inverse_dynamics(q, v, v_dot)
    wanted = [chart.inverse_dynamics(chart.trusted_state(a.copy(), b), c) for a, b, c in zip(q, v, v_dot, strict=True)]
    np.testing.assert_allclose(found, wanted, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("count", SIZES)
@pytest.mark.parametrize("threads", [1, 2])
def test_any_number_of_states_and_threads(count: int, threads: int) -> None:
    made = robot()
    q, v, u, _ = (np.resize(a, (count, a.shape[1])) for a in states("three_prs"))
    found = made.batch.forward_dynamics(q, v, u, threads=threads)
    assert np.array_equal(
        found, np.resize(made.batch.forward_dynamics(*states("three_prs")[:3], threads=1), found.shape)
    )
    assert made.batch.null_space(q).N.shape == (count, 12, 3)
    assert len(made.batch.assemble(q, threads=threads).q) == count


def test_results_go_where_they_are_wanted() -> None:
    made, (q, v, u, v_dot) = robot(), states("three_prs")
    out = np.empty_like(q)
    assert made.batch.forward_dynamics(q, v, u, out=out) is out
    assert np.array_equal(out, made.batch.forward_dynamics(q, v, u))
    forces = np.empty((len(q), 3))
    assert made.batch.inverse_dynamics(q, v, v_dot, out=forces) is forces
    assert np.array_equal(forces, made.batch.inverse_dynamics(q, v, v_dot))


def test_inputs_for_all_states_or_none() -> None:
    made, (q, v, u, v_dot) = robot(), states("three_prs")
    shared = made.batch.forward_dynamics(q, v, u[0])
    assert np.array_equal(shared, made.batch.forward_dynamics(q, v, np.tile(u[0], (len(q), 1))))
    assert np.array_equal(made.batch.forward_dynamics(q, v), made.batch.forward_dynamics(q, v, np.zeros(3)))
    assert np.array_equal(
        made.batch.inverse_dynamics(q, v, v_dot[0]), made.batch.inverse_dynamics(q, v, np.tile(v_dot[0], (len(q), 1)))
    )


def test_every_state_has_its_time() -> None:
    made, (q, v, u, _) = model("driven"), states("driven")
    t = np.linspace(0, 2, len(q))
    found = made.batch.forward_dynamics(q, v, u, t=t)
    for k in range(len(q)):
        assert np.array_equal(found[k : k + 1], made.batch.forward_dynamics(q[k : k + 1], v[k : k + 1], u[k], t=t[k]))
    assert not np.array_equal(found, made.batch.forward_dynamics(q, v, u))
    with pytest.raises(InputError, match=r"the time t is a number or an array \(9,\)"):
        made.batch.velocity(q, v, t=np.zeros(4))
    with pytest.raises(InputError, match="must be finite; it is not for state 2"):
        made.batch.velocity(q, v, t=np.where(np.arange(9) == 2, np.nan, 0.0))


def test_every_state_has_its_parameters() -> None:
    made, (q, v, u, _) = robot(), states("three_prs")
    masses = np.linspace(0.5, 3, len(q))
    found = made.batch.forward_dynamics(q, v, u, parameters={"M": masses, "b": 0.2})
    rows = np.array([made.replace(M=mass).values for mass in masses])  # the disc's inertia follows its mass
    _close(found, made.batch.forward_dynamics(q, v, u, parameters=rows))
    for k, mass in enumerate(masses):
        heavy = made.replace(M=mass)
        _close(found[k : k + 1], heavy.forward_dynamics(heavy.trusted_state(q[k].copy(), v[k].copy()), u[k])[None])
    shared = made.batch.energy(q, v, parameters=np.array(made.replace(M=2.0).values))
    _close(np.stack(shared), np.stack(made.replace(M=2.0).batch.energy(q, v)))
    light = robot().replace(Ixx=0.015)
    masses = np.linspace(0.5, 1.4, len(q))  # a heavier disc could not have that moment
    assert light.batch.energy(q, v, parameters={"M": masses}).kinetic[0] == pytest.approx(
        light.replace(M=masses[0]).batch.energy(q, v).kinetic[0], rel=1e-14
    )


@pytest.mark.parametrize(
    ("parameters", "error", "says"),
    [
        ({"mass": 1.0}, UnknownName, "no parameter 'mass'"),
        ({"M": np.array([1.0, -2.0])}, InputError, r"parameter M is a number or an array \(9,\)"),
        ({"M": -np.arange(9.0)}, ParameterError, r"parameter M must be positive, not -?0 kg \(state 0, 9 in all\)"),
        ({"M": np.where(np.arange(9) == 4, np.nan, 1.0)}, InputError, "parameter M of state 4 must be finite"),
        (np.ones(3), InputError, r"parameter values of a batch are an array \(states, 10\) or \(10,\)"),
        (np.ones((4, 10)), InputError, "parameters for 4 states, but 9 states"),
    ],
)
def test_parameters_that_make_no_sense_are_named(parameters: object, error: type, says: str) -> None:
    q, v, u, _ = states("three_prs")
    with pytest.raises(error, match=says):
        robot().batch.forward_dynamics(q, v, u, parameters=parameters)  # type: ignore[arg-type]


def test_values_that_make_no_sense_are_named() -> None:
    batch, (q, v, u, _) = robot().batch, states("three_prs")
    bad = q.copy()
    bad[4, 2] = bad[6, 0] = np.inf
    for call, says in (
        (lambda: batch.forward_dynamics(bad, v, u), r"coordinate z of state 4 must be finite, not inf \(2 of 9 states"),
        (lambda: batch.forward_dynamics(q, v * np.nan), "independent rate s1 of state 0"),
        (lambda: batch.forward_dynamics(q[0], v), r"coordinate values of a batch are an array \(states, 12\)"),
        (lambda: batch.forward_dynamics(q, v[:, :2]), r"array \(states, 3\) in the order s1, s2, s3, not one of shape"),
        (lambda: batch.forward_dynamics(q, v[:4]), "coordinates for 9 states and rates for 4"),
        (lambda: batch.forward_dynamics(q, v, u[:4]), "there are 9 states, but values for 4"),
        (lambda: batch.forward_dynamics(q.astype(complex), v), "must be real numbers, not complex128"),
        (lambda: batch.forward_dynamics(q, v, dtype=np.int32), "float64 or float32, not int32"),
        (lambda: batch.forward_dynamics(q, v, colour=1), "no option 'colour'"),
        (lambda: batch.forward_dynamics(q, v, singular="zero"), "singular must be one of 'raise', 'nan'"),
        (lambda: batch.assemble(q, dtype=np.float32), "assemble works in float64"),
        (lambda: model("four_bar").batch.inverse_dynamics(*([np.zeros((1, 3))] + [np.zeros((1, 2))] * 2)), "array"),
        (
            lambda: model("andrews").batch.forward_dynamics(np.zeros((2, 7)), np.zeros((2, 1)), out=np.zeros((2, 6))),
            "out",
        ),
    ):
        with pytest.raises(InputError, match=says):
            call()
    huge = np.full((2, 12), 1e308)
    assert np.isfinite(batch_module.rows(huge, robot().coordinates, "coordinate", np.dtype(float))).all()


def test_singular_states_are_never_passed_over() -> None:
    made, (q, v, u, v_dot) = robot(), states("three_prs")
    flat = q.copy()
    flat[[2, 5]] = 0.0  # alpha = 0: the legs lie down, the slides cannot move the platform
    with pytest.raises(SingularityError, match=r"singular in 2 of 9 states, the first one is state 2 \(\|B\| = -?0\)"):
        made.batch.forward_dynamics(flat, v, u)
    for call in (
        lambda **o: made.batch.forward_dynamics(flat, v, u, **o),
        lambda **o: made.batch.inverse_dynamics(flat, v, v_dot, **o),
        lambda **o: made.batch.generalized_forces(flat, v, v_dot, **o),
        lambda **o: made.batch.null_space(flat, v, **o).N,
        lambda **o: made.batch.null_space(flat, v, **o).gamma,
        lambda **o: made.batch.velocity(flat, v, **o),
        lambda **o: made.batch.energy(flat, v, **o).kinetic,
        lambda **o: made.batch.energy(flat, v, **o).potential,
    ):
        with pytest.raises(SingularityError, match="2 of 9 states"):
            call()
        found = call(singular="nan")
        wrong = np.isnan(found).reshape(9, -1)
        assert wrong[[2, 5]].all()
        assert not np.delete(wrong, [2, 5], axis=0).any()


def test_states_are_singular_where_the_model_says_so() -> None:
    """Close to the singularity, where digits are lost one by one: the same verdict state by state."""
    made = build(derive(catalog.four_bar()))
    home = assemble(made, {})
    q = np.tile(home.q, (60, 1))
    free = [k for k in range(len(home.q)) if k not in made.independent_columns]
    q[:, free[1]] = q[:, free[0]] + np.concatenate([np.geomspace(1e-16, 1, 30), -np.geomspace(1e-16, 1, 30)])
    v = np.ones((60, len(made.independent)))
    found = made.batch.velocity(q, v, singular="nan")

    def refused(k: int) -> bool:
        try:
            made.velocity(made.trusted_state(q[k].copy(), v[k].copy()))
        except SingularityError:
            return True
        return False

    assert np.isnan(found).all(axis=1).tolist() == [refused(k) for k in range(60)]


def test_assemblies_are_those_of_assemble() -> None:
    made = robot()
    start = assemble(made, {"s1": 0.6, "s2": 0.6, "s3": 0.6})
    wanted = np.random.default_rng(1).uniform(0.55, 0.65, (40, 3))
    q = np.tile(start.q, (40, 1))
    q[:, made.independent_columns] = wanted
    found = made.batch.assemble(q)
    assert found.closed.all()
    assert np.abs(found.residual).max() <= 1e-14
    assert np.array_equal(found.q[:, made.independent_columns], wanted)
    for k in range(40):
        one = assemble(made, dict(zip(made.independent, wanted[k].tolist(), strict=True)), guess=start)
        np.testing.assert_allclose(found.q[k], one.q, rtol=0, atol=1e-13)
    assert "40 closed" in repr(found)


def test_what_cannot_be_assembled_is_named() -> None:
    made = model("four_bar")
    q = np.tile(assemble(made, {}).q, (3, 1))
    rows = np.tile(np.array(made.values), (3, 1))
    rows[1, 0] *= 50.0  # too long a crank: the loop cannot close
    found = made.batch.assemble(q, parameters=rows)
    assert found.outcome[0] == found.outcome[2] == Assembled.CLOSED
    assert found.outcome[1] in (Assembled.OPEN, Assembled.SINGULAR)
    assert np.isnan(found.q[1]).all()
    assert np.isfinite(found.q[[0, 2]]).all()
    assert found.residual[1] > 1e-9 or np.isnan(found.residual[1])


def test_drivers_are_assembled_at_their_time() -> None:
    made = model("driven")
    q = np.tile(assemble(made, {}).q, (5, 1))
    t = np.linspace(0, 0.2, 5)
    found = made.batch.assemble(q, t=t)
    assert found.closed.all()
    for k in range(5):
        assert np.abs(made.residual(found.q[k], t[k])).max(initial=0.0) <= 1e-13


def test_floats_are_as_good_as_they_are_said_to_be() -> None:
    """An error of 6e-8 in every operation, grown by what the null space and the mass matrix lose."""
    for name in ("three_prs", "stewart_platform", "andrews"):
        made, (q, v, u, v_dot) = model(name), states(name, 200)
        for call in (
            lambda **o: made.batch.forward_dynamics(q, v, u, **o),  # noqa: B023 - used at once
            lambda **o: made.batch.generalized_forces(q, v, v_dot, **o),  # noqa: B023
            lambda **o: made.batch.velocity(q, v, **o),  # noqa: B023
        ):
            double, single = call(), call(dtype=np.float32)
            assert single.dtype == np.float32
            size = np.abs(double).max(axis=1, keepdims=True)
            assert (np.abs(single - double) <= 3e-5 * size).all()
            assert not np.array_equal(single, double)


def test_states_that_are_too_singular_for_floats_are_refused() -> None:
    made, (q, v, _, _) = robot(), states("three_prs")
    near = q.copy()
    near[3, [made.coordinates.index(f"alpha{k}") for k in (1, 2, 3)]] = 1e-6
    assert np.isfinite(made.batch.velocity(near, v)).all()
    with pytest.raises(SingularityError, match="1 of 9 states, the first one is state 3"):
        made.batch.velocity(near, v, dtype=np.float32)


def test_where_the_basis_of_the_kernels_is_singular_the_plain_ones_answer() -> None:
    """Links that point straight up, as at the home, are singular for the platform's coordinates, not for the slides."""
    mechanism = catalog.three_prs()
    made = build(derive(mechanism, basis=("y", "psi", "theta")))
    plain = build(derive(mechanism, basis=("s1", "s2", "s3")))
    q, v, u, v_dot = (a.copy() for a in states("three_prs"))
    q[4] = assemble(plain, {}).q
    doubt = made.library.kernels["forward_dynamics"].blocks(np.float64, ("doubt",))(q, v, u, np.array(made.values))[0]
    assert (~(doubt < REGULAR_DOUBT)).tolist() == [k == 4 for k in range(9)]
    for found, wanted in (
        (made.batch.forward_dynamics(q, v, u), plain.batch.forward_dynamics(q, v, u)),
        (made.batch.inverse_dynamics(q, v, v_dot), plain.batch.inverse_dynamics(q, v, v_dot)),
        (made.batch.generalized_forces(q, v, v_dot), plain.batch.generalized_forces(q, v, v_dot)),
    ):
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)
    q[2] = 0.0
    again = made.batch.forward_dynamics(q, v, u, singular="nan")
    assert np.isnan(again[2]).all()
    assert np.isfinite(np.delete(again, 2, axis=0)).all()


def test_results_go_only_where_they_fit_whatever_the_inputs_drive() -> None:
    made = model("a01_pendulum")  # more inputs than degrees of freedom: u is made in another way
    q, v = np.tile(assemble(made, {}).q, (9, 1)), np.ones((9, 1))
    wanted = made.batch.inverse_dynamics(q, v, v)
    place = np.zeros((9, 2))
    assert made.batch.inverse_dynamics(q, v, v, out=place) is place
    assert np.array_equal(place, wanted)
    locked = np.zeros((9, 2))
    locked.flags.writeable = False
    for out in (np.zeros((9, 2), np.float32), np.zeros((3, 9, 2)), np.zeros((8, 2)), [[0.0] * 2] * 9, locked, 0):
        with pytest.raises(InputError, match="out must be"):
            made.batch.inverse_dynamics(q, v, v, out=out)  # type: ignore[arg-type]
    both = np.zeros(27)
    with pytest.raises(InputError, match="shares memory"):
        made.batch.inverse_dynamics(q, v, both[:9].reshape(9, 1), out=both[:18].reshape(9, 2))


def test_types_that_make_no_sense_are_named() -> None:
    batch, (q, v, *_) = robot().batch, states("three_prs")
    for dtype in ("banana", 3.5, object, np.float16, np.int64, [], ">f8"):
        with pytest.raises(InputError, match="float64 or float32, not"):
            batch.residual(q, dtype=dtype)  # type: ignore[arg-type]
        with pytest.raises(InputError, match="float64 or float32, not"):
            batch.energy(q, v, dtype=dtype)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="singular must be one of"):
        batch.velocity(q, v, singular=np.arange(2))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="independent rate s1 of state 0 must be finite, not inf"):
        batch.velocity(q, np.full_like(v, 1e200), dtype=np.float32)
    with pytest.raises(InputError, match="time t must be finite"):
        batch.velocity(q, v, t=1e200, dtype=np.float32)
