"""Units run by FMPy move as the model does: its own integrator and CVode against simulate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import nullbody
from nullbody.export import write_fmu
from nullbody.export.fmu import source
from tests.export.mock_up import CASES, errors, run, start_of

pytest.importorskip("fmpy", reason="needs the extra fmu")

KINDS = {"CoSimulation": 1e-10, "ModelExchange": 2e-6}  # m, rad; CVode at rtol 1e-9, loops closed at 1e-6 m


@dataclass(frozen=True)
class Case:
    equations: nullbody.Equations
    model: nullbody.Model
    state: nullbody.State
    path: Path
    until: float
    u: tuple[float, ...]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, int], Case]:
    """A mechanism of CASES with its unit, written once."""
    folder = tmp_path_factory.mktemp("units")

    @cache
    def made(name: str, fmi: int = 2) -> Case:
        equations, model, state = start_of(name)
        path = folder / f"{name}{fmi}.fmu"
        assert write_fmu(equations, path, start=state, fmi=fmi).platforms
        _, _, until, u = CASES[name]
        return Case(equations, model, state, path, until, tuple(u))

    return made


def started(case: Case) -> dict[str, float]:
    return dict(zip(case.model.inputs, case.u, strict=True))


def tight(kind: str) -> float:
    return 1e-11 if kind == "CoSimulation" else 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("name", "fmi"), [*((name, 2) for name in CASES), ("three_prs", 3), ("shaken", 3)])
def test_unit_moves_as_the_model(case, name: str, fmi: int, kind: str) -> None:
    c = case(name, fmi)
    found = nullbody.simulate(c.model, c.state, c.until, u=list(c.u), rtol=1e-12, samples=11)
    ran = run(
        c.path, kind, c.until, c.model.coordinates, start_values=started(c), relative_tolerance=tight(kind)
    )  # fmt: skip
    assert ran.log == []
    assert np.abs(found.q - found.q[0]).max() > 1e-4  # something moves
    assert errors(ran, found, c.model.coordinates) < KINDS[kind]


@pytest.mark.parametrize("name", ["three_prs", "shaken", "four_bar"])
def test_outputs_are_those_of_the_model_at_the_same_state(case, name: str) -> None:
    c, model = case(name), case(name).model
    rates, accelerations = [f"{q}_dot" for q in model.coordinates], [f"{q}_ddot" for q in model.coordinates]
    reactions = [f"reaction.{loop}.{row}" for loop, row in (label.split() for label in model.labels)]
    if name == "shaken":
        reactions = [f"reaction.'{label}'" for label in model.labels]
    scalars = ["energy.kinetic", "energy.potential", "power.total", "loops.gap"]
    powers = [f"power.{u}" for u in model.inputs]
    names = [*model.coordinates, *rates, *accelerations, *reactions, *scalars, *powers]
    ran = run(c.path, "CoSimulation", c.until, names, start_values=started(c))
    for k, t in enumerate(ran.t):
        state = model.state(
            [ran[q][k] for q in model.coordinates], [ran[f"{q}_dot"][k] for q in model.independent], t=t
        )
        u, q_dot = np.array(c.u), model.velocity(state)
        wanted = [*state.q, *q_dot, *model.forward_dynamics(state, u), *model.reactions(state, u), *model.energy(state)]
        power = [u[i] * q_dot[j] for i, j in enumerate(model.actuated_columns)]
        got = [ran[n][k] for n in names]
        size = max(1.0, float(np.abs(wanted).max()))
        assert np.abs(np.array(got[: len(wanted)]) - wanted).max() < 1e-9 * size
        assert ran["loops.gap"][k] < 1e-13
        assert np.abs(np.array([ran[n][k] for n in powers]) - power).max(initial=0.0) < 1e-12
        if name != "shaken":  # the shaker works too
            assert ran["power.total"][k] == pytest.approx(sum(power), abs=1e-12)


def test_energy_changes_by_the_power_of_inputs_and_drives(case) -> None:
    c = case("shaken")
    ran = run(c.path, "CoSimulation", 1.0, ["energy.kinetic", "energy.potential", "power.total"], output_interval=0.005)
    energy, power = ran["energy.kinetic"] + ran["energy.potential"], ran["power.total"]
    work = np.sum(power[:-2:2] + 4 * power[1:-1:2] + power[2::2]) * 0.005 / 3  # Simpson
    assert abs(energy[-1] - energy[0]) > 1e-3
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-8)


@pytest.mark.parametrize("kind", KINDS)
def test_inputs_that_jump(case, kind: str) -> None:
    c = case("three_prs")
    times = np.linspace(0.0, 0.5, 11)
    forces = [[np.sin(9 * t), 0.5 - t, t * t] for t in times[:-1]]
    steps = [(t, *f) for (begin, end), f in zip(pairwise(times), forces, strict=True) for t in (begin, end)]
    signals = np.array(steps, [("time", "<f8"), *((name, "<f8") for name in c.model.inputs)])
    ran = run(
        c.path, kind, 0.5, c.model.coordinates, input=signals, relative_tolerance=tight(kind), record_events=False
    )
    assert np.allclose(ran.t, times, rtol=0, atol=1e-12)
    state = c.state
    for k, (begin, end) in enumerate(pairwise(times), 1):
        state = nullbody.simulate(c.model, state, end, t0=begin, u=forces[k - 1], rtol=1e-12).state(end)
        assert max(abs(ran[name][k] - state[name]) for name in c.model.coordinates) < KINDS[kind]


def test_inputs_are_held_over_a_communication_step(case) -> None:
    c = case("three_prs")
    times = np.linspace(0.0, 0.5, 11)
    forces = [[np.sin(9 * t), 0.5 - t, t * t] for t in times]
    columns = [("time", "<f8"), *((name, "<f8") for name in c.model.inputs)]
    signals = np.array([(t, *f) for t, f in zip(times, forces, strict=True)], columns)
    ran = run(c.path, "CoSimulation", 0.5, c.model.coordinates, input=signals, relative_tolerance=1e-11)
    state = c.state
    for k, (begin, end) in enumerate(pairwise(times), 1):
        state = nullbody.simulate(c.model, state, end, t0=begin, u=forces[k - 1], rtol=1e-12).state(end)
        assert max(abs(ran[name][k] - state[name]) for name in c.model.coordinates) < KINDS["CoSimulation"]


def test_loops_that_drift_open_are_closed_by_an_event(case) -> None:
    c = case("three_prs")
    loose = {"relative_tolerance": 1e-4, "output_interval": 0.01, "record_events": False}
    gaps = {}
    for drift in (1e-7, 1.0):
        gaps[drift] = run(c.path, "ModelExchange", 0.5, ["loops.gap"], start_values={"solver.drift": drift}, **loose)[
            "loops.gap"
        ]
    assert gaps[1.0].max() > 1e-6
    assert gaps[1e-7].max() <= 1e-7


@pytest.mark.parametrize("kind", KINDS)
def test_changed_parameters_close_the_loops_again(case, kind: str) -> None:
    c = case("three_prs")
    changed = {"l": 0.56, "b": 0.23, "M": 1.5, "ms": 0.2}
    longer = c.model.replace(**changed)
    known = {name: c.state[name] for name in c.model.independent}
    state = nullbody.assemble(longer, known, v=c.state.v, guess=c.state)
    found = nullbody.simulate(longer, state, 0.3, rtol=1e-12, samples=11)
    ran = run(
        c.path, kind, 0.3, [*c.model.coordinates, "Iyy"], start_values=changed, relative_tolerance=tight(kind)
    )  # fmt: skip
    assert ran["Iyy"][-1] == pytest.approx(longer.parameters["Iyy"], rel=1e-15)
    assert errors(ran, found, c.model.coordinates) < KINDS[kind]


def test_hosts_that_set_every_start_value_close_the_loops_too(case) -> None:
    c = case("three_prs")
    names, changed = c.model.coordinates, {"l": 0.56}
    few = run(c.path, "CoSimulation", 0.1, names, start_values=changed)
    all_ = run(c.path, "CoSimulation", 0.1, names, start_values=changed, apply_default_start_values=True)
    assert max(float(np.abs(few[name] - all_[name]).max()) for name in names) == 0.0


def test_other_start_values_are_assembled(case) -> None:
    c = case("three_prs")
    known = {"s1": 0.5, "s2": 0.62, "s3": 0.66}
    near = run(c.path, "CoSimulation", 1e-9, c.model.coordinates, start_values={**known, "s2_dot": 0.3})
    wanted = nullbody.assemble(c.model, known, guess=c.state)
    assert max(abs(near[name][0] - wanted[name]) for name in c.model.coordinates) < 1e-12
    above = nullbody.assemble(c.model, known)  # the other branch, by a guess of dependent coordinates
    guess = {name: above[name] + 0.01 for name in c.model.coordinates if name not in known}
    far = run(c.path, "CoSimulation", 1e-9, c.model.coordinates, start_values={**known, **guess})
    assert max(abs(far[name][0] - above[name]) for name in c.model.coordinates) < 1e-12
    assert far["y"][0] > 0 > near["y"][0]


def test_a_driven_mechanism_may_start_at_another_time(case) -> None:
    c = case("shaken")
    ran = run(c.path, "CoSimulation", 0.5, c.model.coordinates, start_time=0.7, relative_tolerance=1e-11)
    begin = nullbody.assemble(c.model, {"swing": 0.4}, v=[0.3], t=0.7)
    found = nullbody.simulate(c.model, begin, 1.2, t0=0.7, rtol=1e-12, samples=11)
    assert errors(ran, found, c.model.coordinates) < 1e-10
    assert ran["rail"][0] == pytest.approx(0.05 * np.sin(2.8), abs=1e-14)


def test_inputs_are_held_within_the_limits_of_the_actuator(tmp_path: Path) -> None:
    b = nullbody.MechanismBuilder("limited")
    b.parameter("most", 2.0, "N")
    b.point_mass("cart", 1.0)
    b.prismatic("x", "ground", "cart", axis="x")
    b.actuator("push", "x", limits=("-most", "most"))
    write_fmu(nullbody.derive(b.build()), tmp_path / "limited.fmu")
    for most, u, wanted in ((2.0, 5.0, 2.0), (3.0, -9.0, -3.0), (3.0, 1.0, 1.0)):
        start = {"most": most, "push": u}
        ran = run(tmp_path / "limited.fmu", "CoSimulation", 0.1, ["x_ddot", "push"], start_values=start)
        assert (ran["x_ddot"][-1], ran["push"][-1]) == (wanted, u)


def test_a_planted_sign_error_is_found(case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    c = case("four_bar")
    printed = source.c_functions

    def planted(programs, prefix):
        declarations, definitions = printed(programs, prefix)
        head, name, body = definitions.partition(f"void {prefix}_forward_dynamics")
        assert " - " in body
        return declarations, head + name + body.replace(" - ", " + ", 1)

    monkeypatch.setattr(source, "c_functions", planted)
    write_fmu(c.equations, tmp_path / "wrong.fmu", start=c.state)
    found = nullbody.simulate(c.model, c.state, c.until, u=list(c.u), rtol=1e-12, samples=11)
    ran = run(tmp_path / "wrong.fmu", "CoSimulation", c.until, c.model.coordinates, start_values=started(c))
    assert len(ran.t) < len(found.t) or errors(ran, found, c.model.coordinates) > 1e-3
