"""Models of other mechanisms: inputs that are too few, too many or useless, and motions without mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nullbody import InputError, MechanismError, Model, SingularityError, assemble, build, derive
from nullbody.mechanism import Actuator, Body
from tests.mechanisms import four_bar, slider_crank, tip_mass, two_bodies


def driven(*actuators: Actuator) -> Model:
    return build(derive(replace(four_bar(), actuators=actuators), ("q1",)))


def test_inverse_dynamics_without_inputs_is_refused_and_actuation_says_what_is_missing() -> None:
    model = driven()
    state = assemble(model, {"q1": 1.3}, v=[0.5])
    with pytest.raises(InputError, match=r"'four_bar' has 0 inputs for 1 degrees of freedom.*generalized_forces"):
        model.inverse_dynamics(state, [0.0])
    found = model.actuation(state, [0.0])
    np.testing.assert_array_equal(found.residual, model.generalized_forces(state, [0.0]))
    assert (found.rank, found.feasible, found.u.shape) == (0, False, (0,))


def test_more_inputs_than_degrees_of_freedom_share_the_load_with_least_norm() -> None:
    model = driven(Actuator("t1", "q1"), Actuator("t3", "q3"))
    state = assemble(model, {"q1": 1.3}, v=[0.5])
    u = model.inverse_dynamics(state, [0.7])
    assert model.forward_dynamics(state, u)[0] == pytest.approx(0.7, rel=1e-10)
    found = model.actuation(state, [0.7])
    assert (found.rank, found.feasible, found.null_space.shape) == (1, True, (2, 1))
    assert u @ found.null_space[:, 0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(
        model.forward_dynamics(state, u + 3 * found.null_space[:, 0]), model.forward_dynamics(state, u), rtol=1e-9
    )
    assert model.generalized_forces(state, [0.0]).shape == (1,)


def test_without_inputs_it_still_moves() -> None:
    model = driven()
    state = assemble(model, {"q1": 1.3}, v=[0.5])
    q_ddot = model.forward_dynamics(state)
    assert model.generalized_forces(state, q_ddot[:1]) == pytest.approx([0.0], abs=1e-13)
    assert model.reactions(state, ()).shape == (2,)


def test_two_inputs_on_one_degree_of_freedom_add_up() -> None:
    model, single = driven(Actuator("t1", "q1"), Actuator("t3", "q3")), driven(Actuator("t1", "q1"))
    state = assemble(model, {"q1": 1.3}, v=[0.5])
    ratio = model.null_space(state).N[2, 0]
    np.testing.assert_allclose(
        model.forward_dynamics(state, (0.2, 0.7)), single.forward_dynamics(state, [0.2 + 0.7 * ratio]), rtol=1e-12
    )


def test_inputs_that_cannot_drive_here_are_named() -> None:
    model = build(derive(slider_crank(), ("alpha",)))
    dead = assemble(model, {"alpha": 0.0}, v=[1.0])
    assert np.isfinite(model.forward_dynamics(dead, [1.0])).all()
    with pytest.raises(SingularityError, match="the inputs push cannot drive all degrees of freedom here"):
        model.inverse_dynamics(dead, [1.0])


@pytest.mark.parametrize("distance", [1e-9, 1e-12, 1e-15])
def test_inputs_beside_a_place_where_they_cannot_drive_are_right_or_refused(distance: float) -> None:
    model = build(derive(slider_crank(), ("alpha",)))
    beside = assemble(model, {"alpha": distance}, v=[1.0])
    try:
        u = model.inverse_dynamics(beside, [1.0])
    except SingularityError as error:
        assert distance < 1e-9 and "some motion needs no work of theirs" in str(error)
    else:
        assert distance == 1e-9 and beside["alpha"] == pytest.approx(distance)
        assert model.forward_dynamics(beside, u)[model.independent_columns[0]] == pytest.approx(1.0, abs=1e-6)


def test_inputs_that_can_do_nothing_are_not_feasible() -> None:
    model = build(derive(slider_crank(), ("alpha",)))
    for angle in (0.0, np.pi):  # the dead centres: Br is zero, or what rounding leaves of it
        dead = assemble(model, {"alpha": angle}, v=[1.0])
        found = model.actuation(dead, [1.0])
        assert found.rank == 0 and not found.feasible
        assert found.u.tolist() == [0.0]
        assert found.residual == pytest.approx(model.generalized_forces(dead, [1.0]))


def test_independent_slider_is_singular_at_the_dead_centre() -> None:
    model = build(derive(slider_crank(), ("s",)))
    dead = assemble(model, {"s": 0.45}, v=[1.0])
    with pytest.raises(SingularityError, match=r"the independent coordinates s are singular here"):
        model.forward_dynamics(dead, [1.0])


def test_motion_without_any_mass() -> None:
    massless = replace(four_bar(), bodies=tuple(Body(name) for name in ("crank", "coupler", "rocker")))
    with pytest.raises(MechanismError, match="some motion moves no mass"):
        build(derive(massless))


def test_mechanism_without_loops() -> None:
    model = build(derive(two_bodies()))
    state = assemble(model, {"swing": 0.4}, v=np.arange(8.0))
    N, gamma, delta = model.null_space(state)
    np.testing.assert_array_equal(N, np.eye(8))
    assert not gamma.any()
    assert delta == 1.0
    assert model.reactions(state).shape == (0,)
    assert model.jacobian(state.q).shape == (0, 8)
    with pytest.raises(InputError, match=r"'two_bodies' has 1 inputs for 8 degrees of freedom"):
        model.inverse_dynamics(state, np.zeros(8))


@pytest.mark.parametrize("elbow", [0.0, 1e-9, -1e-7], ids=["stretched", "almost", "nearly"])
def test_singular_mass_matrix_is_refused(elbow: float) -> None:
    model = build(derive(tip_mass()))
    with pytest.raises(SingularityError, match="moves no mass, or next to none"):
        model.forward_dynamics(model.state([0.3, elbow], [0.2, 0.1]))


def test_bent_arm_is_regular() -> None:
    model = build(derive(tip_mass()))
    state = model.state([0.3, 0.05], [0.2, 0.1])
    q_ddot = model.forward_dynamics(state, [1.0, 2.0])
    assert model.inverse_dynamics(state, q_ddot) == pytest.approx([1.0, 2.0], rel=1e-9)
