"""Many initial value problems y' = f(y, ...) in lock step: blocks of 8 states are marched by native code.

One call takes a block through many steps while all it needs stays in the first cache. The programs:

    rate      (y, ...) -> (rate [size], guards [g])
    corrected (y, ...) -> the same and correction [c]: what to add to the first c components of y after a step

y is the first group(s) of the inputs, `size` numbers. The first guard g must keep g side > 1, where side is a sign over
a least size (0: any g will do); the others must stay below their limits in absolute value. A lane that breaks one, or
whose y is not finite, stops at its last good y and says why. The correction of a step is evaluated with the rate at its
end, which is the first rate of the next step.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError
from nullbody.kernels.block import aligned
from nullbody.kernels.compile import compile_blocks, compile_text
from nullbody.kernels.march_ir import JOB, LANES_OF, march_ir
from nullbody.kernels.number import BLOCK
from nullbody.kernels.program import Program
from nullbody.kernels.threads import shared_out

__all__ = ["Lanes", "March"]

_SIGNATURE = ctypes.CFUNCTYPE(
    None, *[ctypes.c_void_p] * 3, *[ctypes.c_double] * 2, *[ctypes.c_int64] * 3
)  # gives the GIL away
_GRAIN = 16  # blocks that a thread takes at a time
_FLOAT, _INTEGER = np.dtype(np.float64), np.dtype(np.int64)
_REGIONS = 10


@dataclass(frozen=True, eq=False)
class Lanes:
    """Where every state stands: block after block, 8 lanes each; lanes beyond the last state repeat it.

    Attributes:
        states: how many there are.
        inputs: (blocks, inputs, 8), the inputs of the programs, y first.
        side: (blocks, 8), the sign that the first guard must keep over its least size: infinite where the sign alone
            counts, 0 where nothing does.
        status: (blocks, 8), 0 while a lane runs; otherwise 1 + the guard that was broken, g + 1 where y would not be
            finite, g + 2 where the step became too small, g + 3 where the guard that is watched exceeds its threshold.
        time: (blocks, 8), where it is.
        step: (blocks, 8), the next step of the adaptive method.
        accepted, refused: (blocks, 8), steps so far.
    """

    states: int
    inputs: NDArray[np.float64]
    side: NDArray[np.float64]
    status: NDArray[np.int64]
    time: NDArray[np.float64]
    step: NDArray[np.float64]
    accepted: NDArray[np.int64]
    refused: NDArray[np.int64]

    def put(self, start: int, values: NDArray[Any]) -> None:
        """Set inputs from `start` on: (states, size), or (size,) for all."""
        place = self.inputs[:, start : start + values.shape[-1]]
        if values.ndim == 1:
            place[...] = values[:, None]
        elif len(values):
            full, rest = divmod(len(values), BLOCK)
            place[:full] = values[: full * BLOCK].reshape(full, BLOCK, values.shape[1]).transpose(0, 2, 1)
            if rest:
                place[full, :, :rest] = values[full * BLOCK :].T
                place[full, :, rest:] = values[-1][:, None]

    def rows(self, start: int, size: int) -> NDArray[np.float64]:
        """Inputs from `start` on as a new array (states, size)."""
        place = self.inputs[:, start : start + size].transpose(0, 2, 1)
        return place.reshape(-1, size)[: self.states].copy() if size else np.empty((self.states, 0))

    def put_each(self, name: str, values: NDArray[Any] | float) -> None:
        """Set one of the other arrays from one value for each state, or one for all."""
        place = getattr(self, name).reshape(-1)
        place[: self.states] = values
        if self.states:
            place[self.states :] = place[self.states - 1]

    def each(self, name: str) -> NDArray[Any]:
        """One of the other arrays as (states,), a view."""
        return np.asarray(getattr(self, name).reshape(-1)[: self.states])


class _Memory(threading.local):
    """Intermediate results of one block; every thread sees its own."""

    def __init__(self, numbers: int) -> None:
        self.array = aligned((numbers, BLOCK), _FLOAT)
        self.place = self.array.ctypes.data


class March:
    """Steps of a Runge-Kutta method around two programs.

    Args:
        rate: the rate and the guards.
        corrected: the same with corrections; the same program where nothing is corrected.
        limits: of all guards but the first.
        time: which input is the time; none by default.
        watched: a guard and a threshold below its limit: a lane that exceeds it after a step stops there.

    Raises:
        InputError: the programs do not fit each other.
        CacheError: the cache cannot be read, written or trusted.
    """

    def __init__(
        self,
        rate: Program,
        corrected: Program,
        limits: Sequence[float],
        time: int | None = None,
        watched: tuple[int, float] | None = None,
    ) -> None:
        shapes = [dict(program.outputs) for program in (rate, corrected)]
        if [*shapes[1]][:2] != ["rate", "guards"] or list(shapes[0].items()) != list(shapes[1].items())[:2]:
            raise InputError("a march needs two programs with the outputs rate and guards, the second with corrections")
        (self.size,), (self.guards,) = shapes[1]["rate"], shapes[1]["guards"]
        self.corrections = sum(shape[0] for shape in list(shapes[1].values())[2:])
        if rate.inputs != corrected.inputs or len(limits) != self.guards - 1 or self.corrections > self.size:
            raise InputError("the programs of a march need the same inputs, a limit for every guard but the first")
        self.inputs = len(rate.tape.inputs)
        self._codes = [compile_blocks(program) for program in (rate, corrected)]
        self._limits = np.array(limits, dtype=np.float64)
        self._time = -1 if time is None else time
        self._watched = watched or (-1, 0.0)
        self._functions = {}
        for name in ("nb_rk4", "nb_dopri"):
            code = compile_text(name, march_ir())
            self._codes.append(code)
            self._functions[name] = _SIGNATURE(code.address)
        self._memory = _Memory(_REGIONS * self.size + self.size + self.guards + self.corrections)

    def lanes(self, states: int) -> Lanes:
        """Room for some states, all zero."""
        blocks = -(-states // BLOCK)
        inputs = aligned((blocks, self.inputs, BLOCK), _FLOAT)
        kinds = (_FLOAT, _INTEGER, _FLOAT, _FLOAT, _INTEGER, _INTEGER)
        return Lanes(states, inputs, *(aligned((blocks, BLOCK), kind) for kind in kinds))

    def fixed(
        self, lanes: Lanes, t1: float, h: float, steps: int, threads: int, part: tuple[int, int] | None = None
    ) -> None:
        """Steps of length h of the classical Runge-Kutta method (order 4), until t1.

        Args:
            lanes: where the states stand; is changed.
            t1: end time; lanes within half a step of it are there.
            h: length of a step.
            steps: how many at most.
            threads: how many work at the same time.
            part: blocks to march, all by default.
        """
        self._march("nb_rk4", lanes, (t1, h), steps, (0.0, 0.0), threads, part)

    def adaptive(
        self,
        lanes: Lanes,
        t1: float,
        tolerances: tuple[float, float],
        attempts: int,
        least: float,
        threads: int,
        part: tuple[int, int] | None = None,
    ) -> None:
        """Steps of Dormand-Prince 5(4), each lane its own, until t1.

        Args:
            lanes: where the states stand, with their next steps; is changed. Lanes that are not at t1 afterwards and
                have not stopped need more attempts.
            t1: end time.
            tolerances: relative and absolute, of the root mean square of the local error and the correction.
            attempts: steps that a lane may try in this call.
            least: a lane that needs a smaller step than that stops.
            threads: how many work at the same time.
            part: blocks to march, all by default.
        """
        self._march("nb_dopri", lanes, (t1, least), attempts, tolerances, threads, part)

    def _march(
        self,
        name: str,
        lanes: Lanes,
        numbers: tuple[float, float],
        count: int,
        tolerances: tuple[float, float],
        threads: int,
        part: tuple[int, int] | None,
    ) -> None:
        first, last = part or (0, len(lanes.inputs))
        known = {
            "rate": self._codes[0].address,
            "corrected": self._codes[1].address,
            "inputs": self.inputs,
            "size": self.size,
            "guards": self.guards,
            "corrections": self.corrections,
            "time": self._time,
            "limits": self._limits.ctypes.data,
            "watched": self._watched[0],
        }
        job = np.array([known.get(key, 0) for key in JOB], dtype=np.int64)
        job[-3:] = np.array([self._watched[1], *tolerances]).view(np.int64)
        places = np.array([getattr(lanes, name).ctypes.data for name in LANES_OF], dtype=np.int64)
        function, where = self._functions[name], (job.ctypes.data, places.ctypes.data)

        def work(begin: int, end: int) -> None:
            function(*where, self._memory.place, *numbers, count, first + begin, first + end)

        shared_out(work, last - first, threads, _GRAIN)
