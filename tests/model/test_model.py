"""The model: parameters, inputs, immutability, threads, and identities of its routines."""

from __future__ import annotations

import dataclasses
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nullbody import CacheError, InputError, ParameterError, UnknownName, build, catalog
from tests.robot import equations, robot, tilted, upright


def test_names() -> None:
    model = robot()
    assert model.coordinates == ("x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "s1", "s2", "s3")
    assert model.independent == ("s1", "s2", "s3")
    assert model.dependent == model.coordinates[:9]
    assert model.inputs == ("F1", "F2", "F3")
    assert model.labels == tuple(f"leg{i} {axis}" for i in (1, 2, 3) for axis in "xyz")
    assert repr(robot().replace(l=0.6)) == "<Model of 'three_prs', v = rates of s1, s2, s3, l=0.6>"


def test_build_takes_equations_or_a_mechanism() -> None:
    assert build(catalog.three_prs()).labels == robot().labels
    with pytest.raises(InputError, match=r"Equations from derive\(mechanism\), or a Mechanism, not str"):
        build("three_prs")  # type: ignore[arg-type]


def test_build_with_parameters_equals_replace() -> None:
    built, replaced = build(equations(), {"l": 0.6, "ms": 0.1}), robot().replace(l=0.6, ms=0.1)
    assert dict(built.parameters) == dict(replaced.parameters)
    with pytest.raises(UnknownName, match="no parameter 'length'"):
        build(equations(), {"length": 0.6})


def test_replace_keeps_the_code_and_derived_defaults_follow() -> None:
    model = robot()
    other = model.replace(l=0.6).replace(b=0.3)
    assert other.library is model.library
    assert model.parameters["l"] == 0.5
    assert (other.parameters["l"], other.parameters["b"]) == (0.6, 0.3)
    assert other.parameters["Iyy"] == pytest.approx(0.3**2 / 2, rel=1e-15)
    kept = model.replace(Ixx=0.02, Iyy=0.03, Izz=0.02).replace(b=0.3)
    assert kept.parameters["Ixx"] == 0.02


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"l": 0}, r"parameter l \(length of the links\) must be positive, not 0 m"),
        ({"l": -0.5}, "must be positive, not -0.5 m"),
        ({"M": float("nan")}, "must be finite, not nan"),
        ({"M": float("inf")}, "must be finite, not inf"),
        ({"l": "0.6"}, "must be a number in m, not '0.6'"),
        ({"l": None}, "must be a number in m, not None"),
        ({"l": True}, "must be a number in m, not True"),
        ({"ms": -1e-9}, "must be non-negative"),
        ({"Ixx": 10.0}, "none may be negative or above the sum"),
    ],
)
def test_parameters_that_are_not_physical(values: dict[str, Any], message: str) -> None:
    for call in (robot().replace, catalog.three_prs, lambda **v: build(equations(), v)):
        with pytest.raises(ParameterError, match=message):
            call(**values)


def test_unknown_parameter() -> None:
    with pytest.raises(UnknownName, match="there is no parameter 'Ixy'; did you mean 'I"):
        robot().replace(Ixy=1.0)


@pytest.mark.parametrize("value", [0.6, np.float64(0.6), np.float32(0.6), Fraction(3, 5), 1, np.int64(1)])
def test_numbers_of_any_kind_are_parameters(value: Any) -> None:
    model = robot().replace(l=value)
    assert model.parameters["l"] == float(value)
    assert upright(model)["y"] == float(value)


@pytest.mark.parametrize(
    "values",
    [{"M": 1e-9}, {"M": 1e9}, {"m": 1e-9}, {"m": 1e9}, {"g": 0}, {"g": -9.8}, {"a": 0.2}, {"a": 0.1}, {"ms": 1e6}],
)
def test_extreme_parameters(values: dict[str, float]) -> None:
    model = robot().replace(**values)
    for state in (upright(model, (0.1, 0.2, -0.3)), *tilted(model, 3)):
        v_dot = np.array([0.3, -0.2, 0.1])
        u = model.inverse_dynamics(state, v_dot)
        found = model.forward_dynamics(state, u)[9:]
        assert np.isfinite(u).all()
        np.testing.assert_allclose(found, v_dot, atol=1e-9 * max(1.0, np.abs(u).max()))


def test_without_gravity_the_robot_rests_anywhere() -> None:
    model = robot().replace(g=0)
    for x in tilted(model, 4):
        assert not model.forward_dynamics(model.state(x.q)).any()


def test_forms_of_the_inputs() -> None:
    model, (x,) = robot(), tilted(robot(), 1)
    wanted = model.forward_dynamics(x, np.array([1.0, 0.0, 2.0]))
    for u in ((1, 0, 2), [1.0, 0.0, 2.0], {"F3": 2, "F1": 1, "F2": 0}):
        np.testing.assert_array_equal(model.forward_dynamics(x, u), wanted)
    np.testing.assert_array_equal(model.forward_dynamics(x), model.forward_dynamics(x, (0, 0, 0)))
    np.testing.assert_array_equal(model.reactions(x), model.reactions(x, (0, 0, 0)))


@pytest.mark.parametrize("u", [1.0, (1, 2), {"F1": 1}, {"F1": 1, "F2": 1, "F3": 1, "F4": 1}, "abc", (1, 2, np.inf)])
def test_wrong_inputs(u: Any) -> None:
    model = robot()
    for call in (model.forward_dynamics, model.reactions):
        with pytest.raises(InputError, match="input"):
            call(upright(model), u)


@pytest.mark.parametrize("v_dot", [None, (1, 2), {"s1": 1}, (1, 2, np.nan), 3.0])
def test_wrong_accelerations(v_dot: Any) -> None:
    model = robot()
    for call in (model.inverse_dynamics, model.acceleration, model.generalized_forces):
        with pytest.raises(InputError, match="independent acceleration"):
            call(upright(model), v_dot)


def test_nobody_can_change_a_model() -> None:
    model = robot().replace(l=0.6)
    with pytest.raises(dataclasses.FrozenInstanceError):
        model.values = ()  # type: ignore[misc]
    for mapping in (model.given, model.parameters):
        with pytest.raises(TypeError):
            mapping["l"] = 1.0  # type: ignore[index]
    results = model.forward_dynamics(upright(model))
    results[:] = 7.0
    assert not (model.forward_dynamics(upright(model)) == 7.0).any()


def test_threads_share_a_model() -> None:
    model = robot()
    states = tilted(model, 40)
    wanted = [model.forward_dynamics(x, (1, 2, 3)) for x in states]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            found = list(pool.map(lambda x: model.forward_dynamics(x, (1, 2, 3)), states))
            np.testing.assert_array_equal(found, wanted)


def test_cache_folder_that_is_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "occupied"
    file.write_text("not a folder")
    monkeypatch.setenv("NULLBODY_CACHE", str(file))
    with pytest.raises(CacheError, match=r"set NULLBODY_CACHE to a folder that you can write, or NULLBODY_CACHE=off"):
        build(equations())
    assert file.read_text() == "not a folder"
    assert list(tmp_path.iterdir()) == [file]


def test_generalized_forces_are_the_slides_forces() -> None:
    model, (x,) = robot(), tilted(robot(), 1)
    np.testing.assert_allclose(model.generalized_forces(x, (1, 2, 3)), model.inverse_dynamics(x, (1, 2, 3)), rtol=1e-13)
