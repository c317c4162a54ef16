"""A kernel bound to memory of its own, for loops in which a call must cost next to nothing."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from math import prod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.block import label, real_numbers

if TYPE_CHECKING:
    from nullbody.kernels.kernel import Kernel

__all__ = ["BoundKernel", "group_views"]


class BoundKernel:
    """A kernel whose inputs and outputs are arrays that stay where they are: a call allocates no arrays.

    Called with vectors for the first input groups, it writes them into `inputs`, leaves the other groups as they are
    and evaluates the program. Results are read from `outputs`; the next call overwrites
    them. Not for several threads at once.

    Args:
        kernel: whose function it calls.

    Attributes:
        inputs: the input groups by name, to write to.
        outputs: the output groups by name, views of the memory that the function writes.
    """

    def __init__(self, kernel: Kernel) -> None:
        program = kernel.program
        self.program = program
        self._kernel = kernel  # keeps the code in memory
        self._source = np.zeros(max(1, len(program.tape.inputs)))
        self._target = np.zeros(max(1, len(program.tape.outputs)))
        self.inputs = group_views(self._source, program.inputs)
        self.outputs = group_views(self._target, program.outputs)
        self._places: tuple[Any, ...] = tuple(
            place.data for place in self.inputs.values()
        )  # take arrays of their size only
        self._results = tuple(self.outputs.values())
        self._function = kernel.function
        self._from, self._to = (ctypes.c_void_p(a.ctypes.data) for a in (self._source, self._target))

    def __call__(self, *groups: ArrayLike) -> tuple[NDArray[np.float64], ...]:
        """Evaluate the program.

        Args:
            groups: vectors for the first input groups, in their order; none where `inputs` holds what is wanted.

        Returns:
            The arrays of `outputs`, in their order.

        Raises:
            InputError: too many groups, or one that does not fit.
        """
        try:
            for place, group in zip(self._places, groups, strict=False):
                place[:] = group
        except (TypeError, ValueError):  # not an array of doubles of this size
            self._convert(groups)
        if len(groups) > len(self._places):
            raise InputError(f"kernel {label(self.program)} takes {len(self._places)} input groups, not {len(groups)}")
        self._function(self._from, self._to)
        return self._results

    def _convert(self, groups: Sequence[ArrayLike]) -> None:
        """Write groups of any numbers."""
        for k, (place, group) in enumerate(zip(self.inputs.values(), groups, strict=False)):
            array = real_numbers(self.program, k, group)
            if array.shape != place.shape:
                name = self.program.inputs[k][0]
                raise InputError(
                    f"kernel {label(self.program)}: input {name!r} has shape {array.shape}, not {place.shape}"
                )
            place[...] = array

    def __repr__(self) -> str:
        return f"<BoundKernel {label(self.program)}>"


def group_views(
    memory: NDArray[np.float64], groups: Sequence[tuple[str, int | tuple[int, ...]]]
) -> Mapping[str, NDArray[np.float64]]:
    """The groups of a program, names with sizes or shapes, as parts of memory one after the other."""
    found, start = {}, 0
    for name, shape in groups:
        size = shape if isinstance(shape, int) else prod(shape)
        found[name] = memory[start : start + size].reshape(shape)
        start += size
    return MappingProxyType(found)
