"""CSV: a trajectory as text that any program reads."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from nullbody.export.target import check_target, replacement

if TYPE_CHECKING:
    from nullbody.simulate import Trajectory

__all__ = ["write_csv"]


def write_csv(trajectory: Trajectory, path: str | os.PathLike[str]) -> None:
    """Write the columns of `trajectory.to_xarray()`: names, comment lines (units first), one row for each sample.

    Every number has the digits that give the same double back. To read it:

        pandas.read_csv(path, comment="#")      # before pandas 3 with float_precision="round_trip"
        numpy.genfromtxt(path, delimiter=",", names=True)

    Args:
        trajectory: from `simulate`.
        path: ends in .csv; a file that is there is replaced.

    Raises:
        OutputError: it cannot be written; what was there before is untouched.
    """
    check_target(path, ".csv")
    dataset = trajectory.to_xarray()
    names = ["t", *(str(name) for name in dataset.data_vars)]
    rows = zip(*(dataset[name].values.tolist() for name in names), strict=True)
    with replacement(path, ".csv") as draft, draft.open("x", encoding="utf-8", newline="\n") as stream:
        print(",".join(names), file=stream)
        print(f"# units: {','.join(dataset[name].attrs['units'] for name in names)}", file=stream)
        for key, value in dataset.attrs.items():
            print(f"# {key}: {value}", file=stream)
        for row in rows:
            print(",".join(map(repr, row)), file=stream)
