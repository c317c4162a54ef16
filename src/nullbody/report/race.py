"""Slow baselines in processes of their own, one after the other in the background, each stopped at its time limit."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["Lap", "Race"]


@dataclass(frozen=True)
class Lap:
    """What came of one method.

    Attributes:
        seconds: its time; nothing where it did not finish [s].
        residual: max |A N| / (|A| |N|) at a state of the robot; nothing where N is not finite there.
        limit: after which it was stopped [s].
        note: why there is no result, or nothing.
    """

    seconds: float | None
    residual: float | None
    limit: float
    note: str = ""


@dataclass
class Race:
    """Runs SymPy baselines in the background from `start` until `results` is asked for.

    Attributes:
        limits: seconds for each method of `symbolic_baseline`, from its first step on; they run in this order,
            or not at all where all limits are zero.
    """

    limits: Mapping[str, float]
    _laps: dict[str, Lap] = field(default_factory=dict)
    _thread: threading.Thread | None = None
    _running: subprocess.Popen[str] | None = None
    _stopped: bool = False

    def start(self) -> Race:
        """Begin, where SymPy is installed and there is time."""
        missing = "SymPy is not installed" if importlib.util.find_spec("sympy") is None else "no time was given"
        if importlib.util.find_spec("sympy") is None or not any(self.limits.values()):
            self._laps = {name: Lap(None, None, limit, missing) for name, limit in self.limits.items()}
            return self
        self._thread = threading.Thread(target=self._run, name="symbolic baselines", daemon=True)
        self._thread.start()
        return self

    def results(self) -> Mapping[str, Lap]:
        """Wait for the last method."""
        if self._thread is not None:
            self._thread.join()
        return self._laps

    def stop(self) -> None:
        """End what is running; for a report that failed."""
        self._stopped = True
        if self._running is not None:
            self._running.kill()
        if self._thread is not None:
            self._thread.join()

    def _run(self) -> None:
        for method, limit in self.limits.items():
            if self._stopped:
                return
            self._laps[method] = self._lap(method, limit)

    def _lap(self, method: str, limit: float) -> Lap:
        command = [sys.executable, "-m", "nullbody.report.symbolic_baseline", method]
        pipe = subprocess.PIPE
        self._running = subprocess.Popen(command, stdout=pipe, stderr=pipe, stdin=subprocess.DEVNULL, text=True)
        try:
            if self._running.stdout is not None:
                self._running.stdout.readline()  # the import of SymPy and the set-up of A do not count
            output, errors = self._running.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            self._running.kill()
            self._running.communicate()
            return Lap(None, None, limit, f"not finished within {limit:g} s")
        if self._running.returncode:
            last = (errors.strip().splitlines() or ["no message"])[-1]
            return Lap(None, None, limit, f"failed: {last[:120]}")
        found = json.loads(output)
        return Lap(found["seconds"], found["residual"], limit)
