"""Units with several charts: co-simulation goes on where one set of independent coordinates becomes singular."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nullbody
from nullbody.export import write_fmu
from tests.export.mock_up import errors, run

pytest.importorskip("fmpy", reason="needs the extra fmu")


def test_co_simulation_goes_over_to_other_independent_coordinates(tmp_path: Path) -> None:
    """The five-bar falls through a singularity of its cranks at 0.2308 s, and through others later."""
    equations = nullbody.derive(nullbody.catalog.mechanism("five_bar"))
    model = nullbody.build(equations)
    write_fmu(equations, tmp_path / "u.fmu", charts=[("phi", "theta1"), ("theta2", "gamma"), ("phi", "gamma")], fmi=3)
    found = nullbody.simulate(model, nullbody.assemble(model, {}), 0.5, rtol=1e-12, samples=11)
    assert found.statistics.switches
    rates, reactions = [f"{name}_dot" for name in model.coordinates], ["reaction." + model.labels[0].replace(" ", ".")]
    names = [*model.coordinates, *rates, *reactions, "loops.gap"]
    ran = run(tmp_path / "u.fmu", "CoSimulation", 0.5, names, relative_tolerance=1e-12)
    assert ran.log == []
    assert errors(ran, found, model.coordinates) < 1e-9
    assert max(float(np.abs(ran[f"{n}_dot"] - found[f"{n}'"]).max()) for n in model.coordinates) < 1e-7
    assert ran["loops.gap"].max() < 1e-13
    for k in (2, 9):
        state = found.state(float(ran.t[k]))
        assert ran[reactions[0]][k] == pytest.approx(model.reactions(state)[0], rel=1e-5)


def test_a_disc_rolls_on_in_other_charts(tmp_path: Path) -> None:
    coin = nullbody.catalog.starts("rolling_disc")["coin"]
    model = nullbody.build(nullbody.derive(coin.mechanism, ("x", "y", "e3")))
    state = model.own(nullbody.consistent(model, coin.q, coin.q_dot).state)
    write_fmu(model, tmp_path / "u.fmu", start=state, charts=[("x", "y", "e0"), ("x", "y", "e1"), ("x", "y", "e2")])
    found = nullbody.simulate(model, state, 0.3, rtol=1e-12, samples=11)
    ran = run(tmp_path / "u.fmu", "CoSimulation", 0.3, model.coordinates, relative_tolerance=1e-12)
    assert ran.log == []
    assert errors(ran, found, model.coordinates) < 1e-9
