"""The robot of theory 2, written out once more in NumPy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nullbody import catalog
from nullbody.catalog import three_prs
from nullbody.equations import Equations, derive
from nullbody.errors import UnknownName
from nullbody.expr import Tape
from nullbody.mechanism import Mechanism
from tests.oracles.robot import COORDINATES, PARAMETERS
from tests.oracles.sample import evaluate, sample

ROOT = np.sqrt(3) / 2
E = np.array([[0, 0, 1], [ROOT, 0, -0.5], [-ROOT, 0, -0.5]])
UP = np.array([0, 1, 0])


@pytest.fixture(scope="module")
def equations() -> Equations:
    return derive(three_prs())


def closures(q: Any, a: float, b: float, l: float) -> Any:  # noqa: E741
    """f_i = (a - s_i) e_i + l (sin(alpha_i) y - cos(alpha_i) e_i) - p - R b e_i [26]."""
    cx, cy, cz, sx, sy, sz = *np.cos(q[3:6]), *np.sin(q[3:6])
    R = np.array(
        [
            [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
            [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
            [-sy, cy * sx, cy * cx],
        ]
    )
    f = []
    for i, e in enumerate(E):
        alpha, s = q[6 + i], q[9 + i]
        leg = (a - s) * e + l * (np.sin(alpha) * UP - np.cos(alpha) * e)
        f.append(leg - q[:3] - R @ (b * e))
    return np.concatenate(f)


def test_coordinates_parameters_and_inputs_in_the_order_of_theory() -> None:
    robot = three_prs()
    assert robot.coordinates == COORDINATES
    assert tuple(parameter.name for parameter in robot.parameters) == PARAMETERS
    assert (robot.inputs, robot.actuated) == (("F1", "F2", "F3"), ("s1", "s2", "s3"))
    assert list(robot.units.values()) == ["m"] * 3 + ["rad"] * 6 + ["m"] * 3
    assert [loop.name for loop in robot.loops] == ["leg1", "leg2", "leg3"]
    assert robot.end_effector == "platform"


def test_default_values_are_the_papers_table_2() -> None:
    expected = {"a": 0.8, "b": 0.2, "l": 0.5, "M": 1.0, "m": 0.1, "g": 9.8, "Ixx": 0.01, "Iyy": 0.02, "Izz": 0.01}
    assert three_prs().values() == pytest.approx({**expected, "ms": 0.0}, rel=1e-15)


def test_bodies_are_a_disc_rods_and_points() -> None:
    bodies = {body.name: body for body in three_prs().bodies}
    assert list(bodies) == ["platform", "link1", "link2", "link3", "slider1", "slider2", "slider3"]
    assert {bodies[f"link{i}"].inertia for i in (1, 2, 3)} == {("m*l^2/12", "m*l^2/12", 0)}  # not m l^2/3: erratum
    assert bodies["slider1"].inertia == (0, 0, 0)


@pytest.mark.parametrize("seed", range(4))
def test_closures_as_written_out(seed: int, equations: Equations) -> None:
    values = sample(seed).values
    q = np.array([values[name] for name in COORDINATES])
    expected = closures(q, values["a"], values["b"], values["l"])
    np.testing.assert_allclose(evaluate({"Phi": equations["Phi"]}, values)["Phi"], expected, atol=4e-15)


@pytest.mark.parametrize("seed", range(4))
def test_jacobian_by_a_complex_step(seed: int, equations: Equations) -> None:
    values = sample(seed).values
    q = np.array([values[name] for name in COORDINATES])
    columns = [closures(q + 1e-30j * unit, values["a"], values["b"], values["l"]).imag / 1e-30 for unit in np.eye(12)]
    found = evaluate({"A": equations["A"]}, values)["A"]
    np.testing.assert_allclose(found, np.transpose(columns), rtol=1e-14, atol=1e-15)
    assert np.count_nonzero(np.abs(found) > 1e-14) == 46


@pytest.mark.parametrize("values", [{}, {"b": 0.3, "l": 0.9, "a": 1.1}, {"l": 0.2}])
def test_home_closes_the_loops(values: dict[str, float], equations: Equations) -> None:
    robot = three_prs(**values)
    numbers = robot.values()
    found = evaluate({"Phi": equations["Phi"]}, numbers | robot.home_values(numbers))["Phi"]
    np.testing.assert_allclose(found, 0, atol=2e-16)


def test_general_inertia_and_slider_mass_enter() -> None:
    eq = derive(three_prs(ms=0.3))
    assert {eq.graph.symbol(name) for name in ("Ixx", "Iyy", "Izz", "ms")} <= _symbols(eq)
    slides = [eq["M"][i][i] for i in (9, 10, 11)]
    assert slides == [eq.graph.symbol("m") + eq.graph.symbol("ms")] * 3


def _symbols(eq: Equations) -> set[Any]:
    outputs = [entry for row in eq["M"] for entry in row]
    tape = Tape.of(outputs, eq.graph.symbols)
    return {eq.graph.symbol(tape.inputs[a]) for operation, a, _ in tape.code if operation == "symbol"}


def test_the_catalog_by_name() -> None:
    assert set(catalog.MODELS) >= {"three_prs"}
    assert isinstance(catalog.mechanism("three_prs", l=0.6), Mechanism)
    assert catalog.mechanism("three_prs", l=0.6) == three_prs(l=0.6)
    with pytest.raises(UnknownName, match="no model in the catalog 'tree_prs'; did you mean 'three_prs'"):
        catalog.mechanism("tree_prs")
    robot = catalog.three_prs(l=0.7)
    assert catalog.closed_form_of(robot) is not None
    assert catalog.closed_form_of(replace(robot, name="other")) is None
    assert catalog.closed_form_of(replace(robot, loops=robot.loops[:2])) is None
