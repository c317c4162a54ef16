from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas
import pytest

from nullbody import Trajectory
from nullbody.export import write_csv


@pytest.fixture
def written(trajectory: Trajectory, folder: Path) -> Path:
    write_csv(trajectory, folder / "run.csv")
    return folder / "run.csv"


def test_numpy_reads_every_bit(trajectory: Trajectory, written: Path) -> None:
    read = np.genfromtxt(written, delimiter=",", names=True)
    expected = trajectory.to_xarray()
    assert set(read.dtype.names) == set(expected.variables)
    for name in read.dtype.names:
        assert read[name].tobytes() == expected[name].values.tobytes()


def test_pandas_reads_it(trajectory: Trajectory, written: Path) -> None:
    read = pandas.read_csv(written, comment="#")
    assert list(read.columns) == ["t", *trajectory.to_xarray().data_vars]
    np.testing.assert_allclose(read["alpha2"], trajectory["alpha2"], rtol=1e-15)


def test_units_follow_the_names(written: Path) -> None:
    names, units, *rest = written.read_text(encoding="utf-8").splitlines()
    unit = dict(zip(names.split(","), units.removeprefix("# units: ").split(","), strict=True))
    assert (unit["t"], unit["x"], unit["phi"], unit["s2_dot"], unit["F3"]) == ("s", "m", "rad", "m/s", "N")
    assert "# parameter_l: 0.6" in rest
    assert sum(not line.startswith("#") for line in rest) == 21
