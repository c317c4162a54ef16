"""Starts of published motions, and the closed form behind homes of planar mechanisms."""

from __future__ import annotations

import inspect
from math import hypot, pi

import numpy as np
import pytest

from nullbody import build, catalog, derive
from nullbody.catalog import Start
from nullbody.catalog.dyad import dyad, meets
from nullbody.errors import ParameterError, UnknownName
from nullbody.kinematics import consistent


@pytest.mark.parametrize("name", sorted(catalog.STARTS))
def test_starts_are_closed_and_their_rates_fit(name: str) -> None:
    for start in catalog.starts(name).values():
        model = build(derive(start.mechanism))
        assert set(start.q) == set(start.q_dot) == set(model.coordinates)
        found = consistent(model, start.q, start.q_dot)
        assert found.open_by < 1e-14
        assert found.slipped_by < 1e-14
        assert start.duration > 0
        assert start.source


@pytest.mark.parametrize("name", sorted(catalog.STARTS))
def test_parameters_have_units_and_meanings_and_are_documented(name: str) -> None:
    mechanism = catalog.mechanism(name)
    assert mechanism.name == name
    assert mechanism.inputs
    assert mechanism.end_effector
    for parameter in mechanism.parameters:
        assert parameter.unit
        assert parameter.meaning
    assert "Source: " in inspect.getdoc(catalog.MODELS[name])  # type: ignore[operator]


def test_starts_take_other_parameters() -> None:
    found = catalog.starts("rolling_disc", r=0.2)
    assert [start.mechanism.values()["r"] for start in found.values()] == [0.2, 0.2, 0.2]
    assert found["generic"].q["z"] == pytest.approx(0.2 * np.cos(pi / 9))
    assert catalog.starts("rolling_disc")["coin"].mechanism.values()["r"] == 0.01
    assert len(catalog.starts("n_four_bar", n=5)["upright"].q) == 11


def test_mechanisms_without_published_motions_start_at_home() -> None:
    start = catalog.starts("three_prs")["home"]
    assert start.q["y"] == 0.5
    assert not any(start.q_dot.values())


def test_wrong_names_are_named() -> None:
    with pytest.raises(UnknownName, match="flyball_gouvernor"):
        catalog.starts("flyball_gouvernor")
    with pytest.raises(UnknownName, match="length"):
        catalog.starts("andrews", length=1)
    with pytest.raises(UnknownName, match="z"):
        Start(catalog.a01_pendulum(), {"z": 1})
    with pytest.raises(UnknownName, match="theta"):
        Start(catalog.a01_pendulum(), rates={"theta": 1})


@pytest.mark.parametrize("n", [0, -1, 2.5, True, float("nan"), float("inf"), "3"])
def test_the_number_of_four_bars_is_a_whole_one(n: object) -> None:
    with pytest.raises(ParameterError, match="whole number"):
        catalog.n_four_bar(n)  # type: ignore[arg-type]


def test_a_row_of_three_four_bars() -> None:
    row = catalog.mechanism("n_four_bar", n=3)
    assert row == catalog.n_four_bar(3) == catalog.n_four_bar(3.0)  # type: ignore[arg-type]
    assert row.coordinates == ("theta0", "theta1", "theta2", "theta3", "phi1", "phi2", "phi3")


@pytest.mark.parametrize(("ra", "rb"), [(1.0, 1.5), (2.0, 0.7), (0.4, 1.7)])
def test_a_dyad_meets_on_the_left(ra: float, rb: float) -> None:
    a, b = (0.3, -0.2), (1.1, 1.0)
    x, y = dyad(a, b, ra, rb)
    assert hypot(x - a[0], y - a[1]) == pytest.approx(ra, rel=1e-15)
    assert hypot(x - b[0], y - b[1]) == pytest.approx(rb, rel=1e-15)
    assert (b[0] - a[0]) * (y - a[1]) > (b[1] - a[1]) * (x - a[0])
    assert meets(a, b, ra, rb)


def test_bars_that_cannot_meet_are_stretched_out() -> None:
    assert dyad((0.0, 0.0), (5.0, 0.0), 1.0, 1.0) == pytest.approx((1.0, 0.0))
    assert dyad((0.0, 0.0), (1.0, 0.0), 1.0, 9.0) == pytest.approx((-1.0, 0.0))
    assert not meets((0.0, 0.0), (5.0, 0.0), 1.0, 1.0)
    assert not meets((0.0, 0.0), (1.0, 0.0), 1.0, 9.0)
    four_bar = catalog.four_bar(coupler=1.0, rocker=1.0, base=20.0)
    assert np.isfinite(list(four_bar.home_values(four_bar.values()).values())).all()
