from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray

from nullbody import Trajectory
from nullbody.export import write_netcdf


def test_every_bit_comes_back(trajectory: Trajectory, folder: Path) -> None:
    write_netcdf(trajectory, folder / "run.nc")
    with xarray.open_dataset(folder / "run.nc", engine="h5netcdf") as read:
        expected = trajectory.to_xarray()
        assert read.identical(expected)  # values, names, order, attributes
        for name in expected.variables:
            assert read[name].values.tobytes() == expected[name].values.tobytes()


def test_units_and_parameters_come_back(trajectory: Trajectory, folder: Path) -> None:
    write_netcdf(trajectory, str(folder / "run.nc"))
    with xarray.open_dataset(folder / "run.nc", engine="h5netcdf") as read:
        units = {name: read[name].attrs["units"] for name in ("t", "y", "alpha1", "s1_dot", "F1", "work")}
        assert units == {"t": "s", "y": "m", "alpha1": "rad", "s1_dot": "m/s", "F1": "N", "work": "J"}
        assert read.attrs["parameter_l"] == 0.6
        np.testing.assert_array_equal(read["psi"], trajectory["psi"])
