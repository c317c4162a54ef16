"""The case that all sections share: the paper's robot, derived, built, and its desired motion."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from nullbody.catalog import three_prs
from nullbody.control import DesiredMotion, desired_motion, paper_reference
from nullbody.equations import Equations, derive
from nullbody.errors import VerificationError
from nullbody.model import Model, State, build
from nullbody.typing import FloatArray
from nullbody.verify import AbstractEngine, MujocoEngine, PinocchioEngine

__all__ = ["Case", "Settings", "Timing", "paper_case", "timed_in_fresh_process"]

END = 3.0  # s, of the paper's trajectory


@dataclass(frozen=True)
class Settings:
    """How much is computed; the defaults are those of `reproduce`, tests take less.

    Attributes:
        duration: how much of the paper's 3 s is simulated [s].
        samples: points of each curve.
        marks: engine markers on each curve.
        states: random states against each engine.
        errata_states: random states for the errata.
        symbolic_limit: seconds after which a symbolic baseline is stopped, roughly; 0 leaves them out.
        repeats: of each timing.
        engines: names of the engines.
    """

    duration: float = END
    samples: int = 301
    marks: int = 25
    states: int = 50
    errata_states: int = 200
    symbolic_limit: float = 8.0
    repeats: int = 9
    engines: tuple[str, ...] = ("mujoco", "pinocchio")


@dataclass(frozen=True)
class Timing:
    """Seconds to derive (first time after the import) and to build with an empty and with a filled cache."""

    derive: float
    cold: float
    warm: float


@dataclass(frozen=True, eq=False)
class Case:
    """The robot with the paper's numbers.

    Attributes:
        settings: how much is computed.
        equations, model: of the 3-PRS with s1, s2, s3 independent.
        desired: the paper's trajectory [47].
        timing: of derive and build.
        engines: the independent engines that are installed, by name.
        missing: why others are not there, by name.
    """

    settings: Settings
    equations: Equations
    model: Model
    desired: DesiredMotion
    timing: Timing
    engines: dict[str, AbstractEngine]
    missing: dict[str, str]

    @cached_property
    def times(self) -> FloatArray:
        """The times of the curves [s]."""
        return np.linspace(0.0, self.settings.duration, self.settings.samples)

    @cached_property
    def mark_times(self) -> FloatArray:
        """The times of the engines' markers [s]."""
        return np.linspace(0.0, self.settings.duration, self.settings.marks)

    @cached_property
    def states(self) -> list[State]:
        """The desired states at `times`."""
        return [self.desired.state(float(t)) for t in self.times]

    @cached_property
    def forces(self) -> FloatArray:
        """The forces of inverse dynamics at `times` [N]."""
        demands = (self.desired.demand(float(t)) for t in self.times)
        pairs = zip(self.states, demands, strict=True)
        return np.array([self.model.inverse_dynamics(x, demand.acceleration) for x, demand in pairs])

    def sliders(self, times: FloatArray) -> FloatArray:
        """The desired slider positions, times x 3 [m]."""
        return np.array([self.desired.demand(float(t)).position for t in times])

    def tracking_error(self, times: FloatArray, q: FloatArray) -> FloatArray:
        """Largest |s_i - desired| at each time, for coordinates times x nq [m]."""
        error: FloatArray = np.abs(q[:, -3:] - self.sliders(times)).max(axis=1)
        return error


def paper_case(settings: Settings) -> Case:
    """Derive and build the robot, follow the desired motion, and start the engines."""
    equations = derive(three_prs(), ("s1", "s2", "s3"))
    model = build(equations)
    engines: dict[str, AbstractEngine] = {}
    missing: dict[str, str] = {}
    kinds: dict[str, Any] = {"mujoco": MujocoEngine, "pinocchio": PinocchioEngine}
    for name in settings.engines:
        try:
            engines[name] = kinds[name](model.mechanism, model.parameters, model.labels)
        except VerificationError as error:
            missing[name] = str(error)
    return Case(
        settings=settings,
        equations=equations,
        model=model,
        desired=desired_motion(model, paper_reference(), settings.duration),
        timing=timed_in_fresh_process(),
        engines=engines,
        missing=missing,
    )


_PROCESSES = 3

_PROGRAM = """
import json, statistics, time
from nullbody.catalog import three_prs
from nullbody.equations import derive
from nullbody.model import build
import llvmlite.binding

def timed(f, repeats=1):
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        result = f()
        seconds.append(time.perf_counter() - begin)
    return result, statistics.median(seconds)

mechanism = three_prs()
equations, derived = timed(lambda: derive(mechanism, ("s1", "s2", "s3")))
model, cold = timed(lambda: build(equations))
again, warm = timed(lambda: build(equations), 5)
assert (model.library.origin, again.library.origin) == ("compiled", "cache")
print(json.dumps({"derive": derived, "cold": cold, "warm": warm}))
"""


def timed_in_fresh_process() -> Timing:
    """Time derive and build in new Python processes with empty kernel caches: the least of `_PROCESSES` each.

    Other work on the machine only ever adds to a time.
    """
    found = []
    for _ in range(_PROCESSES):
        with tempfile.TemporaryDirectory(prefix="nullbody-report-") as folder:
            environment = {**os.environ, "NULLBODY_CACHE": folder}
            command = [sys.executable, "-c", _PROGRAM]
            done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=60)
        found.append(json.loads(done.stdout))
    return Timing(**{name: min(times[name] for times in found) for name in found[0]})
