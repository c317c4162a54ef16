from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from nullbody.catalog import three_prs
from nullbody.errors import MechanismError, ParameterError, UnknownName
from nullbody.mechanism import Body, Mechanism, Parameter, Prismatic


def _with(*parameters: Parameter) -> Mechanism:
    return Mechanism("m", (Body("cart", 1),), (Prismatic("slide", "ground", "cart", ("s",)),), parameters=parameters)


BAD = [0, 0.0, -1, -0.5, math.nan, math.inf, -math.inf, 10**400, "0.5", "", None, True, False, 1j, [1], (1.0,)]


@pytest.mark.parametrize("value", BAD)
def test_a_length_is_a_positive_finite_number(value: object) -> None:
    with pytest.raises(ParameterError, match="parameter l "):
        three_prs(l=value)


@pytest.mark.parametrize("value", [1, 0.25, Fraction(1, 3), np.float64(0.7), np.float32(0.5), np.int64(2)])
def test_any_real_number_type_will_do(value: object) -> None:
    found = Parameter("l", 1.0).check(value)
    assert type(found) is float
    assert found == float(value)


def test_signs() -> None:
    assert Parameter("m", 1.0, sign="non-negative").check(0) == 0.0
    assert Parameter("g", 1.0, sign="any").check(-9.8) == -9.8
    with pytest.raises(ParameterError, match=r"must be non-negative, not -1 kg$"):
        Parameter("m", 1.0, "kg", sign="non-negative").check(-1)
    with pytest.raises(ParameterError, match=r"must be finite"):
        Parameter("g", 1.0, sign="any").check(math.nan)


def test_the_message_says_what_unit_and_value() -> None:
    with pytest.raises(ParameterError, match=r"parameter l \(length of the links\) must be positive, not 0 m$"):
        three_prs(l=0)
    with pytest.raises(ParameterError, match=r"must be a number in kg, not 'heavy'"):
        three_prs(M="heavy")


def test_an_unknown_parameter_suggests_the_nearest() -> None:
    with pytest.raises(UnknownName, match=r"no parameter 'Ixy'; did you mean 'I(xx|yy)'"):
        three_prs(Ixy=1.0)
    with pytest.raises(UnknownName, match="no parameter"):
        three_prs().values({"mass": 1.0})


def test_defaults_follow_other_parameters_unless_given() -> None:
    assert three_prs().values({"b": 0.4})["Ixx"] == pytest.approx(0.04)
    assert three_prs(b=0.4).values()["Iyy"] == pytest.approx(0.08)
    assert three_prs(Ixx=0.05, b=0.4).values({"b": 0.39})["Ixx"] == 0.05
    assert three_prs(b=0.4).values({"Iyy": 0.05})["Iyy"] == 0.05


def test_with_parameters_changes_defaults_only() -> None:
    first = three_prs()
    second = first.with_parameters(l=0.6)
    assert (first.values()["l"], second.values()["l"]) == (0.5, 0.6)
    assert second.with_parameters(l=0.5) == first
    assert first.with_parameters() == first


def test_with_parameters_refuses_an_impossible_body() -> None:
    with pytest.raises(ParameterError, match="'platform' would have the principal moments"):
        three_prs(Iyy=1.0)


def test_defaults_in_a_circle() -> None:
    made = _with(Parameter("a", "b"), Parameter("b", "c + 1"), Parameter("c", "2*a"))
    with pytest.raises(MechanismError, match="circle: a -> b -> c -> a"):
        made.values()
    assert made.values({"c": 1.0}) == {"a": 2.0, "b": 2.0, "c": 1.0}


def test_a_default_that_is_not_physical() -> None:
    with pytest.raises(ParameterError, match="the default of parameter d: division by zero"):
        _with(Parameter("a", 1.0), Parameter("d", "1/(a - 1)")).values()
    with pytest.raises(ParameterError, match="parameter d must be positive"):
        _with(Parameter("a", 1.0), Parameter("d", "a - 1")).values()
