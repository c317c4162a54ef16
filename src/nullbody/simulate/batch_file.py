"""Results of many robots on disk, one time after the other, in NetCDF-4: what xarray reads a part of at a time.

The file grows beside its place under the name <name>.part; at the end it takes its place. It does so too where the
simulation is interrupted or fails, and then says so: `complete` is 0, and t ends early. Where the process is killed
there is the draft only.
"""

from __future__ import annotations

import os
import shutil
from errno import ENOSPC
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import OutputError
from nullbody.model import Model
from nullbody.simulate.batch_result import BatchTrajectory, contents
from nullbody.typing import FloatArray

__all__ = ["BatchFile", "checked_path"]

_CHUNK = 2**20  # bytes of one chunk of the file
_SLACK = 4 * _CHUNK  # chunks that are not full, and what HDF5 writes besides
_ADVICE = "Choose a folder that you can write and that has space"


def checked_path(to: object) -> Path:
    """Where the file will be, checked before any work is done.

    Raises:
        OutputError: it does not end in .nc, or there is no such folder that can be written.
    """
    if not isinstance(to, str | os.PathLike):
        raise OutputError(f"to must be the path of a file that ends in .nc, not {to!r:.80}")
    try:
        path = Path(to).expanduser()
        path.with_name(path.name + ".part").is_file()
    except (OSError, RuntimeError, ValueError) as error:  # a name that is too long, a home that is not known
        raise OutputError(f"{os.fspath(to)!r:.80} cannot be written: {error!s:.80}. {_ADVICE}") from None
    if "\0" in str(path):
        raise OutputError(f"{os.fspath(to)!r:.80} cannot be written: the name has a null character")
    if path.suffix.lower() != ".nc" or path.is_dir():
        raise OutputError(f"{path} cannot be written: it must be a file whose name ends in .nc")
    if not (path.parent.is_dir() and os.access(path.parent, os.W_OK | os.X_OK)):
        raise OutputError(f"{path} cannot be written: the folder {path.parent} is missing or not writable. {_ADVICE}")
    return path


class BatchFile:
    """A file that takes the states of all robots at one time after the other.

    Args:
        path: where it will be.
        model: the model.
        robots: how many.
    """

    def __init__(self, path: Path, model: Model, robots: int) -> None:
        import h5netcdf

        self._written = 0  # times
        self.path, self.draft = path, path.with_name(path.name + ".part")
        sizes = {"robot": robots, "coordinate": len(model.coordinates), "independent": len(model.independent)}
        try:
            self._file = h5netcdf.File(self.draft, "w")
            self._file.dimensions = {"t": None, **sizes}
            self._file.create_variable("t", ("t",), "f8").attrs["units"] = "s"
            for name, last in (("q", "coordinate"), ("v", "independent")):
                columns = sizes[last]
                some = max(1, min(robots, _CHUNK // (8 * max(1, columns))))
                chunks = (1, some, max(1, columns))
                self._file.create_variable(
                    name, ("t", "robot", last), "f8", chunks=chunks if robots and columns else None, fillvalue=np.nan
                )
            self._file.attrs["complete"] = 0
            self._file.attrs["mechanism"] = model.mechanism.name
            self._file.flush()
        except OSError as error:
            raise self._failed(error) from error

    def write(self, index: int, t: float, q: FloatArray, v: FloatArray) -> None:
        """The states at one time.

        Raises:
            OutputError: the system refused to write.
        """
        try:
            self._reserve(q.nbytes + v.nbytes)
            self._file.resize_dimension("t", index + 1)
            self._file["t"][index] = t
            self._put("q", index, q)
            self._put("v", index, v)
            self._written = index + 1
            self._file.flush()
        except OSError as error:
            raise self._failed(error) from error

    def finish(self, trajectory: BatchTrajectory) -> None:
        """Write what is known at the end, mark the file as complete and put it in its place.

        Raises:
            OutputError: the system refused to write.
        """
        variables, coordinates, attributes = contents(trajectory)
        try:
            self._reserve(sum(2 * values.nbytes for _, values, _ in variables.values()))
            if "parameter" in coordinates:
                self._file.dimensions["parameter"] = len(coordinates["parameter"][1])
            for name, (dimensions, values, attrs) in {**coordinates, **variables}.items():
                if name != "t":
                    self._add(name, dimensions, values, attrs)
            for name, value in attributes.items():
                self._file.attrs[name] = value
            self.close()
        except OSError as error:
            raise self._failed(error) from error

    def close(self) -> None:
        """Put the file in its place as it is, without a time that was being written."""
        self._file.resize_dimension("t", self._written)
        self._file.close()
        self.draft.replace(self.path)

    def _reserve(self, size: int) -> None:
        """See to it that there is room on the disk before HDF5 writes: it does not survive a disk that is full.

        Raises:
            OSError: there is no such room.
        """
        if hasattr(os, "posix_fallocate"):
            with self.draft.open("r+b") as stream:
                there = os.fstat(stream.fileno()).st_size
                try:
                    os.posix_fallocate(stream.fileno(), there, size + _SLACK)
                finally:
                    os.ftruncate(stream.fileno(), there)
        elif shutil.disk_usage(self.draft.parent).free < size + _SLACK:
            raise OSError(ENOSPC, os.strerror(ENOSPC))

    def _put(self, name: str, index: int, values: FloatArray) -> None:
        if values.size:
            self._file[name][index] = values

    def _add(self, name: str, dimensions: Any, values: NDArray[Any], attributes: dict[str, Any]) -> None:
        import h5py  # type: ignore[import-untyped]

        axes = (dimensions,) if isinstance(dimensions, str) else dimensions
        kind = h5py.string_dtype() if values.dtype == object else values.dtype
        variable = self._file.create_variable(name, axes, kind, data=values if values.size else None)
        for key, value in attributes.items():
            variable.attrs[key] = value

    def _failed(self, error: OSError) -> OutputError:
        return OutputError(f"{self.path} cannot be written: {error.strerror or error}. {_ADVICE}")
