"""One method of another tool on some matrices, in a process that can be stopped.

`python -m nullbody.bench.peer.process METHOD MATRIX ...` prints, for each matrix, a line when its work begins and one
line of JSON when it is done: seconds, operations, and |A N| / (|A| |N|) at a sample. A matrix is the name of a function
of `nullbody.bench.matrix` with its arguments, such as absolute_chain:4 or random_sparse:8:11.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import import_module
from typing import Any

import numpy as np

from nullbody.bench import matrix as matrices
from nullbody.bench.exact import residual
from nullbody.bench.matrix import Matrix
from nullbody.bench.peer.given import Given, Solved
from nullbody.bench.peer.table import PEERS

__all__ = ["main", "named_matrix"]

_SHORT = 0.05  # s: what takes less is repeated, the first time pays for what is loaded lazily
_DEEP = 100_000  # expressions that are printed or hashed may be this deep


def named_matrix(name: str) -> Matrix:
    """A matrix by its name."""
    function, *arguments = name.split(":")
    made: Matrix = getattr(matrices, function)(*map(int, arguments))
    return made


def main(method: str, *names: str) -> None:
    """Run one method on some matrices and print what came of it."""
    place = import_module(f"nullbody.bench.peer.{PEERS[method].place}")
    for name in names:
        matrix = named_matrix(name)
        values = matrix.sample(np.random.default_rng(0), 1)[0]
        work = place.METHODS[method](Given(matrix, values.tolist()))
        print("ready", flush=True)
        begin = time.perf_counter()
        solved = work()
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds}), flush=True)
        if seconds < _SHORT:
            seconds = min(seconds, *_again(place.METHODS[method], Given(matrix, values.tolist())))
        print(json.dumps({"seconds": seconds} | _judged(matrix, values, solved)), flush=True)


def _again(method: Any, given: Given) -> list[float]:
    """Seconds of more runs, from new scalars."""
    found = []
    for _ in range(5):
        work = method(given)
        begin = time.perf_counter()
        work()
        found.append(time.perf_counter() - begin)
    return found


def _judged(matrix: Matrix, values: Any, solved: Solved) -> dict[str, Any]:
    """Operations, and the residual; nothing where N is not finite at the sample."""
    try:
        N = solved.value(values.tolist())
        found = residual(matrix.numbers(values[None])[0][:, matrix.order], N)
    except (ZeroDivisionError, OverflowError):
        found = float("nan")
    return {"operations": solved.operations(), "residual": found if np.isfinite(found) else None}


if __name__ == "__main__":
    sys.setrecursionlimit(_DEEP)
    main(*sys.argv[1:])
