"""NetCDF-4: a trajectory with units, parameters and statistics."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from nullbody.export.target import check_target, replacement

if TYPE_CHECKING:
    from nullbody.simulate import Trajectory

__all__ = ["write_netcdf"]


def write_netcdf(trajectory: Trajectory, path: str | os.PathLike[str]) -> None:
    """Write what `trajectory.to_xarray()` holds; `xarray.open_dataset(path)` reads it back bit for bit.

    Args:
        trajectory: from `simulate`.
        path: ends in .nc; a file that is there is replaced.

    Raises:
        OutputError: it cannot be written; what was there before is untouched.
    """
    check_target(path, ".nc")
    dataset = trajectory.to_xarray()
    content = dataset.to_netcdf(engine="h5netcdf")  # in memory: HDF5 itself does not survive a disk that is full
    with replacement(path, ".nc") as draft:
        draft.write_bytes(content)
