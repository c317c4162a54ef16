"""Results of many robots on disk: the same as in memory, and what is left where a simulation does not end."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray

from nullbody import BatchTrajectory, simulate_batch
from nullbody.errors import OutputError
from nullbody.simulate.batch_file import BatchFile
from tests.robot import robot
from tests.simulate.test_batch import TIMES, starts


@pytest.mark.parametrize("count", [0, 1, 9])
def test_a_file_holds_what_memory_holds(count: int, tmp_path: Path) -> None:
    made, (q, v) = robot(), starts()
    masses = {"parameters": {"M": np.linspace(1, 2, count)}} if count > 1 else {}
    path = tmp_path / "motions.nc"
    memory = simulate_batch(made, (q[:count], v[:count]), TIMES, **masses)
    file = simulate_batch(made, (q[:count], v[:count]), TIMES, to=path, **masses)
    assert isinstance(file, BatchTrajectory)
    assert np.array_equal(file.q, memory.q)
    assert np.array_equal(file.v, memory.v)
    with file.to_xarray() as dataset:
        assert dataset.attrs["complete"] == 1
        assert dataset.sizes == {"t": 5, "robot": count, "coordinate": 12, "independent": 3} | (
            {"parameter": 10} if count > 1 else {}
        )
        loaded = dataset.load()
    wanted = memory.to_xarray()
    assert set(loaded.variables) == set(wanted.variables)
    for name, variable in wanted.variables.items():
        assert np.array_equal(loaded[name].values.astype(variable.dtype), variable.values), name
        assert loaded[name].dims == variable.dims
    assert set(loaded.attrs) == set(wanted.attrs)
    assert loaded["q"].sel(coordinate="s1").shape == (5, count)
    assert [p.name for p in tmp_path.iterdir()] == ["motions.nc"]


def test_a_file_is_read_in_parts(tmp_path: Path) -> None:
    found = simulate_batch(robot(), starts(), TIMES, to=tmp_path / "motions.nc")
    with xarray.open_dataset(tmp_path / "motions.nc") as dataset:
        assert not dataset["q"].variable._in_memory
        assert np.array_equal(dataset["q"].isel(t=2, robot=slice(3, 5)).values, found.q[2, 3:5])


def test_a_simulation_that_fails_leaves_a_file_that_says_so(tmp_path: Path) -> None:
    path = tmp_path / "motions.nc"

    def fails(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        if t > 0.07:
            raise RuntimeError("out of fuel")
        return np.zeros(3)

    with pytest.raises(RuntimeError, match="out of fuel"):
        simulate_batch(robot(), starts(), TIMES, fails, to=path)
    with xarray.open_dataset(path) as dataset:
        assert dataset.attrs["complete"] == 0
        assert dataset["t"].values.tolist() == TIMES[:3].tolist()
        assert np.array_equal(dataset["q"].values, simulate_batch(robot(), starts(), TIMES).q[:3])
    assert [p.name for p in tmp_path.iterdir()] == ["motions.nc"]


LONG = """
import signal
import sys
import numpy as np
signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background inherits that it is ignored
from nullbody import simulate_batch
from tests.robot import robot
from tests.simulate.test_batch import starts
print("ready", flush=True)
try:
    simulate_batch(robot(), starts(count=200), np.linspace(0, 0.2, 2001), step=2e-7, to=sys.argv[1])
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for another process")
def test_an_interrupt_leaves_a_file_that_says_so(tmp_path: Path) -> None:
    path = tmp_path / "motions.nc"
    process = subprocess.Popen([sys.executable, "-c", LONG, str(path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    limit = time.monotonic() + 60
    while not any(tmp_path.iterdir()):  # it writes: the simulation has begun
        assert time.monotonic() < limit
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert said == "interrupted\n"
    with xarray.open_dataset(path) as dataset:
        assert dataset.attrs["complete"] == 0
        assert 1 <= dataset.sizes["t"] < 2001
        assert np.isfinite(dataset["q"].values).all()


def test_an_interrupt_amid_a_time_leaves_that_time_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put = BatchFile._put

    def interrupted(self: BatchFile, name: str, index: int, values: np.ndarray) -> None:
        if (name, index) == ("v", 3):
            raise KeyboardInterrupt
        put(self, name, index, values)

    monkeypatch.setattr(BatchFile, "_put", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulate_batch(robot(), starts(), TIMES, to=tmp_path / "motions.nc")
    with xarray.open_dataset(tmp_path / "motions.nc") as dataset:
        assert dataset["t"].values.tolist() == TIMES[:3].tolist()
        assert np.isfinite(dataset["v"].values).all()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits on files there")
def test_a_full_disk_is_named_and_what_was_written_is_kept(tmp_path: Path) -> None:
    code = (
        "import resource\nfrom tests.simulate.test_batch_file import *\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (5_000_000, 5_000_000))\n"
        "try:\n"
        "    times = np.linspace(0, 0.01, 3000)\n"
        f"    simulate_batch(robot(), starts(), times, step=1e-3, to={str(tmp_path / 'run.nc')!r})\n"
        "except OutputError as error:\n    print(error)"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, timeout=60, check=True
    )
    assert "run.nc cannot be written: File too large. Choose a folder" in done.stdout
    assert not done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]
    with xarray.open_dataset(tmp_path / "run.nc") as dataset:
        assert dataset.attrs["complete"] == 0
        assert 10 < dataset.sizes["t"] < 3000
        assert np.isfinite(dataset["q"].values).all()


def test_a_killed_process_leaves_nothing_in_place_of_the_file(tmp_path: Path) -> None:
    code = (
        "import numpy as np, sys\nfrom tests.simulate.test_batch_file import *\n"
        f"simulate_batch(robot(), starts(), np.linspace(0, 0.2, 401), step=2e-6, to={str(tmp_path / 'run.nc')!r})"
    )
    process = subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parents[2])
    draft = tmp_path / "run.nc.part"
    limit = time.monotonic() + 20
    while not (draft.exists() and draft.stat().st_size > 50_000) and process.poll() is None:
        assert time.monotonic() < limit
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert not (tmp_path / "run.nc").exists()
    assert draft.exists()
    with simulate_batch(robot(), starts(), TIMES, to=tmp_path / "run.nc").to_xarray() as dataset:
        assert dataset.attrs["complete"] == 1
    assert not draft.exists()


@pytest.mark.parametrize("name", ["motions.csv", "nowhere/motions.nc", ".", "x" * 300 + ".nc", "a\0b.nc"])
def test_files_that_cannot_be_written_are_named_before_the_work(name: str, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        simulate_batch(robot(), starts(), 1e9, to=tmp_path / name)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(OutputError, match="must be the path"):
        simulate_batch(robot(), starts(), 1e9, to=3)


def test_a_home_that_is_not_known_is_named() -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        simulate_batch(robot(), starts(), 1e9, to="~nobody-of-this-name/run.nc")
