"""Work on many pieces by several threads: native code gives the GIL away, so that they run at the same time."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from itertools import count
from numbers import Integral

from nullbody.errors import InputError

__all__ = ["cores", "shared_out", "thread_count"]


def cores() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count(threads: object) -> int:
    """The number of threads asked for; None is `cores()`.

    Raises:
        InputError: it is no whole number, or less than 1.
    """
    if threads is None:
        return cores()
    if isinstance(threads, bool) or not isinstance(threads, Integral) or threads < 1:
        raise InputError(f"threads must be a whole number from 1, or None for all cores, not {threads!r}")
    return int(threads)


def shared_out(work: Callable[[int, int], None], pieces: int, threads: int, grain: int) -> None:
    """work(begin, end) for all pieces, `grain` of them at a time, by up to `threads` threads, this one among them.

    Returns or raises when no thread works any more: what they write may be let go.
    """
    chunks = -(-pieces // grain)
    numbers = count()
    stopped = False

    def worker() -> None:
        while not stopped and (k := next(numbers)) < chunks:
            work(k * grain, min((k + 1) * grain, pieces))

    others: list[Future[None]] = [_pool().submit(worker) for _ in range(min(threads, chunks) - 1)]
    try:
        worker()
    except BaseException:
        stopped = True
        raise
    finally:
        for other in others:
            if not other.cancel():  # one that has not begun finds nothing left to do
                other.result()


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=max(64, cores()), thread_name_prefix="nullbody")


if hasattr(os, "register_at_fork"):  # threads do not live on in a child process
    os.register_at_fork(after_in_child=_pool.cache_clear)
