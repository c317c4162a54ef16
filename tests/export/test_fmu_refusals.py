"""Nothing wrong is returned without a word: units that refuse, by name, and what write_fmu refuses."""

from __future__ import annotations

import ctypes
import shutil
from pathlib import Path

import numpy as np
import pytest

import nullbody
from nullbody.errors import InputError, OutputError, UnknownName
from nullbody.export import write_fmu
from nullbody.export.fmu import binary
from tests.export.mock_up import run, start_of

fmpy = pytest.importorskip("fmpy", reason="needs the extra fmu")
fmi1 = pytest.importorskip("fmpy.fmi1", reason="needs the extra fmu")
fmi2 = pytest.importorskip("fmpy.fmi2", reason="needs the extra fmu")
validate_fmu = pytest.importorskip("fmpy.validation", reason="needs the extra fmu").validate_fmu


@pytest.fixture(scope="module")
def three_prs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return unit_of("three_prs", tmp_path_factory, 2)


@pytest.fixture(scope="module")
def three_prs_3(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return unit_of("three_prs", tmp_path_factory, 3)


def unit_of(name: str, tmp_path_factory: pytest.TempPathFactory, fmi: int) -> Path:
    equations, _, state = start_of(name)
    path = tmp_path_factory.mktemp("unit") / f"{name}.fmu"
    write_fmu(equations, path, start=state, fmi=fmi)
    return path


@pytest.fixture(scope="module", params=[2, 3])
def five_bar(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """From home it falls into a singularity of its cranks, at 0.2308 s."""
    path = tmp_path_factory.mktemp("unit") / f"five_bar_{request.param}.fmu"
    write_fmu(nullbody.derive(nullbody.catalog.mechanism("five_bar")), path, fmi=request.param)
    return path


def version(path: Path) -> str:
    return fmpy.read_model_description(str(path)).fmiVersion


def test_co_simulation_ends_before_a_singularity_by_name(five_bar: Path) -> None:
    if version(five_bar) == "3.0":  # FMPy raises at once
        heard: list[str] = []
        with pytest.raises(Exception, match="fmi3DoStep"):
            fmpy.simulate_fmu(str(five_bar), stop_time=0.3, logger=lambda *a: heard.append(a[-1].decode()))
        assert heard[0].startswith("SINGULAR_INDEPENDENT_SET at t = 0.2307")
        return
    ran = run(five_bar, "CoSimulation", 0.3, ["theta1"], relative_tolerance=1e-10)
    assert len(ran.log) == 1
    assert ran.log[0].startswith("SINGULAR_INDEPENDENT_SET at t = 0.2307")
    assert "theta1, theta2" in ran.log[0]
    assert ran.t[-1] == pytest.approx(0.230768809, abs=1e-7)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # FMPy's callback into CVode
def test_model_exchange_is_refused_at_a_singularity_by_name(five_bar: Path) -> None:
    import fmpy.sundials

    heard: list[str] = []
    with pytest.raises(RuntimeError, match="right-hand side"):
        fmpy.simulate_fmu(
            str(five_bar), stop_time=0.3, fmi_type="ModelExchange", logger=lambda *a: heard.append(a[-1].decode())
        )  # fmt: skip
    assert heard
    assert all(line.startswith("SINGULAR_INDEPENDENT_SET at t = 0.23") for line in heard)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"M": -1.0}, "BAD_PARAMETER: parameter M = -1"),
        ({"l": float("nan")}, "BAD_PARAMETER: parameter l = nan"),
        ({"b": 0.0}, "BAD_PARAMETER: parameter b = 0"),
        ({"l": 0.02}, "BRANCH_ENDS: "),
        ({"s1": 3.0}, "BRANCH_ENDS: "),
        ({"s1": float("inf")}, "NOT_FINITE"),
        ({"s1_dot": float("nan")}, "NOT_FINITE"),
        ({"y": 9.0, "l": 0.02}, "LOOPS_OPEN"),
        ({"solver.tolerance": 1.0}, "BAD_PARAMETER: parameter solver.tolerance = 1"),
        ({"solver.drift": -1.0}, "BAD_PARAMETER: parameter solver.drift = -1"),
    ],
)
@pytest.mark.parametrize("fmi", [2, 3])
def test_bad_values_are_refused_at_initialization(
    three_prs: Path, three_prs_3: Path, fmi: int, start: dict[str, float], message: str
) -> None:
    unit = three_prs if fmi == 2 else three_prs_3
    heard: list[str] = []
    with pytest.raises(fmi1.FMICallException):
        fmpy.simulate_fmu(
            str(unit), stop_time=0.1, start_values=start, logger=lambda *a: heard.append(a[-1].decode())
        )  # fmt: skip
    assert heard[0].startswith(message)


def test_an_input_that_is_not_finite_ends_the_run_by_name(three_prs: Path) -> None:
    ran = run(three_prs, "CoSimulation", 0.1, ["y"], start_values={"F1": 1.0})
    assert ran.log == []
    signals = np.array([(0.0, 0.0), (0.05, 0.0), (0.05, np.nan), (0.1, np.nan)], [("time", "<f8"), ("F1", "<f8")])
    with pytest.raises(fmi1.FMICallException):  # the outputs there are refused as well
        run(three_prs, "CoSimulation", 0.1, ["y", "y_ddot"], input=signals)


class Slave:
    """A unit instantiated by hand."""

    def __init__(self, path: Path, folder: Path, *, guid: str | None = None) -> None:
        description = fmpy.read_model_description(str(path))
        self.vr = {v.name: v.valueReference for v in description.modelVariables}
        fmpy.extract(str(path), str(folder))
        self.heard: list[str] = []
        logger = fmi2.fmi2CallbackLoggerTYPE(lambda *a: self.heard.append(a[-1].decode()))
        self.callbacks = fmi2.fmi2CallbackFunctions(logger=logger)
        self.unit = fmi2.FMU2Slave(
            guid=guid or description.guid, unzipDirectory=str(folder), modelIdentifier="three_prs", instanceName="robot"
        )  # fmt: skip
        self.unit.instantiate(callbacks=self.callbacks)

    def start(self) -> None:
        self.unit.setupExperiment(startTime=0.0)
        self.unit.enterInitializationMode()
        self.unit.exitInitializationMode()

    def values(self) -> list[float]:
        return list(self.unit.getReal([self.vr[name] for name in ("x", "y", "s1", "s1_dot", "s1_ddot")]))


@pytest.fixture
def slave(three_prs: Path, tmp_path: Path):
    made = Slave(three_prs, tmp_path / "unit")
    yield made
    made.unit.freeInstance()


def test_a_stored_state_gives_the_same_bits_again(slave: Slave) -> None:
    slave.start()
    slave.unit.doStep(0.0, 0.05)
    stored = slave.unit.getFMUState()
    bytes_ = slave.unit.serializeFMUState(stored)
    slave.unit.doStep(0.05, 0.05)
    first = slave.values()
    slave.unit.setFMUState(stored)
    slave.unit.doStep(0.05, 0.05)
    assert slave.values() == first
    again = slave.unit.deSerializeFMUstate(bytes_)
    slave.unit.setFMUState(again)
    slave.unit.doStep(0.05, 0.05)
    assert slave.values() == first
    slave.unit.freeFMUState(stored)
    slave.unit.freeFMUState(again)


@pytest.mark.parametrize("name", ["chart", "mode"])
def test_bytes_that_are_no_state_are_refused(slave: Slave, name: str) -> None:
    """Both are places in tables: out of range they would end the host."""
    slave.start()
    stored = slave.unit.getFMUState()
    bytes_ = bytearray(slave.unit.serializeFMUState(stored))
    good = bytes(bytes_)
    end = len(bytes_) - len(bytes_) % 8
    tail = np.frombuffer(good[:end], np.int32)[-6:]  # chart, tolerance_given, guess_given, closed, mode, filler
    place = end - 24 + 4 * {"chart": 0, "mode": 4}[name]
    assert tail.tolist()[:5] == [0, 0, 0, 1, 2]
    bytes_[place : place + 4] = np.int32(1000000).tobytes()
    with pytest.raises(fmi1.FMICallException):
        slave.unit.deSerializeFMUstate(bytes(bytes_))
    assert slave.heard == ["these bytes are no stored state of this unit"]
    slave.unit.freeFMUState(stored)


def test_rates_before_the_simulation_are_those_after_it(slave: Slave) -> None:
    """Inputs count, and parameters that follow are settled, also while a host initializes."""
    rates_of = slave.unit.dll.fmi2GetDerivatives

    def rates() -> np.ndarray:
        found = np.zeros(15)
        assert rates_of(ctypes.c_void_p(slave.unit.component), ctypes.c_void_p(found.ctypes.data), 15) == 0
        return found

    slave.unit.setupExperiment(startTime=0.0)
    slave.unit.enterInitializationMode()
    slave.unit.setReal([slave.vr["F1"], slave.vr["M"]], [5.0, 3.0])
    before = rates()
    slave.unit.exitInitializationMode()
    np.testing.assert_array_equal(before, rates())
    slave.unit.setReal([slave.vr["F1"]], [0.0])
    assert np.abs(rates() - before).max() > 0.1


def test_reset_begins_anew(slave: Slave) -> None:
    slave.start()
    first = slave.values()
    slave.unit.doStep(0.0, 0.05)
    assert slave.values() != first
    slave.unit.reset()
    slave.start()
    assert slave.values() == first


def test_parameters_cannot_change_while_it_runs(slave: Slave) -> None:
    slave.start()
    with pytest.raises(fmi1.FMICallException):
        slave.unit.setReal([slave.vr["M"]], [2.0])
    assert slave.heard == ["BAD_VALUE: parameters and start values can be set before the simulation only"]


def test_a_parameter_that_follows_cannot_be_set(slave: Slave) -> None:
    with pytest.raises(fmi1.FMICallException):
        slave.unit.setReal([slave.vr["Iyy"]], [2.0])
    assert "follows from others" in slave.heard[0]


def test_steps_follow_each_other(slave: Slave) -> None:
    slave.start()
    with pytest.raises(fmi1.FMICallException):
        slave.unit.doStep(0.3, 0.1)
    with pytest.raises(fmi1.FMICallException):
        slave.unit.doStep(0.0, -0.1)
    assert len(slave.heard) == 2


def test_the_binary_of_another_unit_is_refused(three_prs: Path, tmp_path: Path) -> None:
    with pytest.raises(Exception, match="nstantiat"):
        Slave(three_prs, tmp_path / "unit", guid="{0}")


# -- what write_fmu refuses --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pendulum() -> nullbody.Model:
    return nullbody.build(nullbody.derive(nullbody.catalog.mechanism("a01_pendulum")))


def test_without_a_compiler_the_unit_holds_its_sources(
    pendulum: nullbody.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(binary, "find_spec", lambda name: None)
    written = write_fmu(pendulum, tmp_path / "p.fmu")
    assert written.platforms == ()
    assert written.note.startswith("no C compiler was found: the unit holds its sources alone")
    assert validate_fmu(str(tmp_path / "p.fmu")) == []
    with pytest.raises(InputError, match="there is no compiler for linux64 here: install the package ziglang"):
        write_fmu(pendulum, tmp_path / "p.fmu", platforms=["linux64"])


def test_a_compiler_that_fails_leaves_what_was_there(
    pendulum: nullbody.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = binary.here()
    if own is None:
        pytest.skip("no name for this platform")
    (tmp_path / "p.fmu").write_bytes(b"before")
    monkeypatch.setattr(binary, "compiler", lambda target: ["false"])
    with pytest.raises(OutputError, match=f"false cannot compile the unit for {own}"):
        write_fmu(pendulum, tmp_path / "p.fmu", platforms=[own])
    assert (tmp_path / "p.fmu").read_bytes() == b"before"


def test_wrong_arguments_are_refused_by_name(pendulum: nullbody.Model, tmp_path: Path) -> None:
    path = tmp_path / "p.fmu"
    with pytest.raises(InputError, match="fmi must be 2 or 3, not 1"):
        write_fmu(pendulum, path, fmi=1)
    with pytest.raises(UnknownName, match="there is no platform 'linux'; did you mean 'linux64'"):
        write_fmu(pendulum, path, platforms=["linux"])
    for platforms in ("linux64", 3):
        with pytest.raises(InputError, match="platforms must be a list"):
            write_fmu(pendulum, path, platforms=platforms)
    with pytest.raises(InputError, match="a Model from build or Equations from derive, not str"):
        write_fmu("three_prs", path)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="start must be a State"):
        write_fmu(pendulum, path, start=[0, 1])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="another mechanism"):
        write_fmu(pendulum, path, start=start_of("four_bar")[2])
    for charts in (["x"], None, 3, [3]):
        with pytest.raises(InputError, match="charts are lists of names"):
            write_fmu(pendulum, path, charts=charts)
    with pytest.raises(UnknownName, match="'w'"):
        write_fmu(pendulum, path, charts=[("w",)])
    with pytest.raises(OutputError, match=r"must end in \.fmu"):
        write_fmu(pendulum, tmp_path / "p.zip")
    assert not list(tmp_path.iterdir())


def test_a_singular_start_is_refused(pendulum: nullbody.Model, tmp_path: Path) -> None:
    singular = pendulum.in_chart(("x",))
    with pytest.raises(InputError, match="the unit cannot begin in this state: the independent coordinates x are"):
        write_fmu(singular, tmp_path / "p.fmu", start=singular.state({"x": 1.0, "y": 0.0}))
