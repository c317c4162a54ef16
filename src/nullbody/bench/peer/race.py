"""Methods of other tools in processes of their own, in the background, each stopped at its time limit."""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from nullbody.bench.peer.table import PEERS

__all__ = ["Heat", "Lap", "Race"]

_START = 60.0  # s for loading a tool and writing down a matrix, which does not count
_JUDGING = 20.0  # s for counting and testing a result


@dataclass(frozen=True)
class Heat:
    """One process: a method, and the matrices that it goes through until it is stopped.

    Attributes:
        method: a name of `PEERS`.
        matrices: names as in `nullbody.bench.peer.process`, from easy to hard.
        limit: seconds for each matrix.
    """

    method: str
    matrices: tuple[str, ...]
    limit: float


@dataclass(frozen=True)
class Lap:
    """What came of one method on one matrix.

    Attributes:
        seconds: its time; nothing where it did not finish [s].
        residual: max |A N| / (|A| |N|) at a sample; nothing where N is not finite there.
        limit: after which it was stopped [s].
        operations: after elimination of common parts.
        note: why there is no result, or nothing.
    """

    seconds: float | None
    residual: float | None
    limit: float
    operations: int | None = None
    note: str = ""

    @property
    def stopped(self) -> bool:
        """Whether the time limit ended it: its time is then known to be more."""
        return self.note.startswith("not finished")


@dataclass
class Race:
    """Runs heats in the background from `start` until `results` is asked for.

    Attributes:
        heats: in the order in which they begin.
        workers: how many run side by side.
    """

    heats: Sequence[Heat]
    workers: int = 1
    _laps: dict[tuple[str, str], Lap] = field(default_factory=dict)
    _threads: list[threading.Thread] = field(default_factory=list)
    _running: set[subprocess.Popen[str]] = field(default_factory=set)
    _stopped: bool = False

    def start(self) -> Race:
        """Begin. Methods whose tool is missing, or that get no time, are noted and left out."""
        waiting: queue.SimpleQueue[Heat] = queue.SimpleQueue()
        for heat in self.heats:
            why = PEERS[heat.method].missing or ("" if heat.limit > 0 else "no time was given")
            if why:
                self._laps |= {(name, heat.method): Lap(None, None, heat.limit, note=why) for name in heat.matrices}
            else:
                waiting.put(heat)
        for number in range(min(self.workers, waiting.qsize())):
            thread = threading.Thread(target=self._work, args=(waiting,), name=f"peers {number}", daemon=True)
            self._threads.append(thread)
            thread.start()
        return self

    @property
    def done(self) -> int:
        """How many matrices have their result."""
        return len(self._laps)

    def results(self) -> Mapping[tuple[str, str], Lap]:
        """Wait for the last heat; laps by (matrix, method)."""
        for thread in self._threads:
            thread.join()
        return self._laps

    def stop(self) -> None:
        """End what is running; for a report that failed."""
        self._stopped = True
        for process in list(self._running):
            process.kill()
        self.results()

    def _work(self, waiting: queue.SimpleQueue[Heat]) -> None:
        while not self._stopped:
            try:
                heat = waiting.get_nowait()
            except queue.Empty:
                return
            self._run(heat)

    def _run(self, heat: Heat) -> None:
        command = [sys.executable, "-m", "nullbody.bench.peer.process", heat.method, *heat.matrices]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, stdout=pipe, stderr=pipe, stdin=subprocess.DEVNULL, text=True) as process:
            self._running.add(process)
            if self._stopped:  # between the last look and now
                process.kill()
            lines: queue.SimpleQueue[str] = queue.SimpleQueue()
            errors: list[str] = []
            readers = [
                threading.Thread(target=_read, args=(process, lines), daemon=True),
                threading.Thread(target=lambda: errors.extend(process.stderr or ()), daemon=True),
            ]
            for reader in readers:
                reader.start()
            reason = ""
            for name in heat.matrices:
                lap = Lap(None, None, heat.limit, note=f"not tried: {reason}") if reason else _lap(heat.limit, lines)
                if not reason and lap.note:
                    process.kill()
                    reason = f"{name.replace(':', ' ')} took too long"
                    if lap.note == _ENDED:
                        readers[1].join()
                        reason = f"failed: {(errors or ['no message'])[-1].strip()[:120]}"
                        lap = Lap(None, None, heat.limit, note=reason)
                self._laps[name, heat.method] = lap
            process.wait()
            for reader in readers:
                reader.join()
        self._running.discard(process)


_ENDED = "ended early"


def _read(process: subprocess.Popen[str], lines: queue.SimpleQueue[str]) -> None:
    """Lines of a process as they come, and an empty one at its end."""
    for line in process.stdout or ():
        lines.put(line.strip())
    lines.put("")


def _lap(limit: float, lines: queue.SimpleQueue[str]) -> Lap:
    """One matrix: "ready", the time, and the time with what was found."""
    texts: list[str] = []
    for wait in (_START, limit, _JUDGING):
        begin = time.perf_counter()
        try:
            texts.append(lines.get(timeout=wait))
        except queue.Empty:
            if len(texts) == 2:
                return Lap(json.loads(texts[1])["seconds"], None, limit, note="finished, but too large to be tested")
            spent = time.perf_counter() - begin
            return Lap(None, None, limit, note=f"not finished within {min(spent, wait):.3g} s")
        if not texts[-1]:
            return Lap(None, None, limit, note=_ENDED)
    found = json.loads(texts[-1])
    return Lap(found["seconds"], found["residual"], limit, found["operations"])
