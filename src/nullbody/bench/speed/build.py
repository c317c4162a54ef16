"""From bodies, joints and loops to native code: the 3-PRS derived and built in new Python processes.

Cold: the cache is empty, all is derived and compiled. Warm: another new process finds everything in the cache. Imports
are timed apart; all times are those of the processor. Engines build their models in milliseconds: they derive nothing,
and evaluate the tree anew at every call.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from statistics import median

from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.interleave import CLOCK
from nullbody.bench.speed.mujoco_peer import MujocoSoft
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.bench.speed.pinocchio_peer import pinocchio_direct
from nullbody.bench.speed.result import Line
from nullbody.bench.speed.sympy_peer import SympyDynamics
from nullbody.bench.timing import Timing
from nullbody.model import Model

__all__ = ["build_lines"]

_WORK = "3-PRS, from bodies and joints to a function"
_IMPORTS = """
import json, time
begin = time.process_time()
import llvmlite.binding
from nullbody.catalog import three_prs
from nullbody.equations import derive
from nullbody.model import build
imported = time.process_time()
"""
_WHOLE = f"""{_IMPORTS}
model = build(three_prs(), independent=("s1", "s2", "s3"))
both = time.process_time()
found = {{"import": imported - begin, "both": both - imported}}
print(json.dumps(found | {{"compiled": float(model.library.origin == "compiled")}}))
"""
_STEPS = f"""{_IMPORTS}
equations = derive(three_prs(), ("s1", "s2", "s3"))
derived = time.process_time()
model = build(equations)
built = time.process_time()
found = {{"derive": derived - imported, "build": built - derived}}
print(json.dumps(found | {{"compiled": float(model.library.origin == "compiled")}}))
"""
_PATIENCE = 120.0  # [s] of one process


def build_lines(model: Model, sympy: Callable[[], SympyDynamics], effort: Effort) -> list[Line]:
    """Derive and build, cold and warm, beside what engines and SymPy need before their first call."""
    whole, steps = _processes(_WHOLE, effort.processes), _processes(_STEPS, effort.processes)
    both = [cold["both"] for cold, _ in whole]
    again = any(warm["compiled"] for _, warm in whole + steps)
    used = "new process, compiled again: the cache was no use" if again else "new process, all in the cache"

    def own(tool: str, seconds: Sequence[float], note: str, reference: bool = False) -> Line:
        ratio = median(a / b for a, b in zip(seconds, both, strict=True))
        return Line("build", _WORK, tool, "ours", Timing.of(seconds), ratio, reference, note=note)

    lines = [
        own("nullbody, build(mechanism), cold", both, "derives, and LLVM compiles", reference=True),
        own("nullbody, build(mechanism), warm", [warm["both"] for _, warm in whole], used),
        own("nullbody, derive", [cold["derive"] for cold, _ in steps], "equations to look at"),
        own("nullbody, build(equations), cold", [cold["build"] for cold, _ in steps], "LLVM compiles"),
        own("nullbody, build(equations), warm", [warm["build"] for _, warm in steps], "code in the cache"),
        own("nullbody, import", [cold["import"] for cold, _ in whole], "LLVM with it; not counted in the rows above"),
    ]
    peers = [
        _peer("MuJoCo, MJCF to model", lambda: MujocoSoft(model.mechanism, model.given), "derives nothing"),
        _peer(
            "Pinocchio, joints to model",
            lambda: pinocchio_direct(model.mechanism, model.parameters, model.labels),
            "derives nothing",
        ),
        _sympy_line(sympy),
    ]
    reference = median(both)
    return lines + [replace(p, ratio=p.time.median / reference) if p.time is not None else p for p in peers]


def _processes(program: str, count: int) -> list[tuple[Mapping[str, float], Mapping[str, float]]]:
    """What new processes print: cold and warm ones in turns, each pair with a cache of its own."""
    found: list[tuple[Mapping[str, float], Mapping[str, float]]] = []
    for _ in range(count):
        with tempfile.TemporaryDirectory(prefix="nullbody-bench-") as folder:
            found.append((_process(program, folder), _process(program, folder)))
    return found


def _process(program: str, folder: str) -> dict[str, float]:
    environment = {**os.environ, "NULLBODY_CACHE": folder}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=_PATIENCE)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def _peer(tool: str, make: Callable[[], object], note: str) -> Line:
    line = Line("build", _WORK, tool, "peer", note=note)
    seconds = []
    try:
        make()
        for _ in range(5):
            begin = CLOCK()
            make()
            seconds.append(CLOCK() - begin)
    except (Missing, Stopped) as error:
        return replace(line, note=str(error))
    return replace(line, time=Timing.of(seconds))


def _sympy_line(make: Callable[[], SympyDynamics]) -> Line:
    line = Line("build", _WORK, "SymPy, M, h, A, c and lambdify", "peer", note="in full coordinates, interpreted code")
    try:
        return replace(line, time=Timing(make().seconds, 0.0))
    except (Missing, Stopped) as error:
        return replace(line, note=str(error))
