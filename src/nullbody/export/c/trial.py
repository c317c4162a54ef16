"""Reference numbers for the code in C: a state, what the LLVM kernels find there, and how far rounding may lead.

Both round every operation, LLVM fuses some multiply-adds, and libm's sines are not LLVM's. So a result may differ by
4 ulp, and by twice what it moves when every operation of the program is off by up to half an ulp, as rounding is.
ulp is that of the largest entry of a result: entries that cancel have no more digits than their neighbours. Where
rounding leaves less than half of its digits, as of closures that repeat others, ulp is that of 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.export.c.face import faces
from nullbody.export.c.limits import EPSILON
from nullbody.export.c.subject import Subject
from nullbody.kernels import Program
from nullbody.typing import FloatArray
from nullbody.verify import admissible_states

__all__ = ["Reference", "Trial", "trial"]

_ULPS = 4  # that a result may differ by in any case
_ROUNDED = 2  # times what roundings do to it: two roads are compared
_LANES = 32  # disturbed runs
_AJAR = 0.1  # of a coordinate: closures are compared with open loops, where Phi is more than rounding


@dataclass(frozen=True, eq=False)
class Reference:
    """One result of a routine.

    Attributes:
        routine, name: which one.
        values: what the LLVM kernel finds, row by row.
        ulp: of the largest entry, in the exported type.
        bound: how many of these the code in C may be away.
    """

    routine: str
    name: str
    values: FloatArray
    ulp: float
    bound: float


@dataclass(frozen=True, eq=False)
class Trial:
    """The state and the results there.

    Attributes:
        inputs: groups by name; `q_open` is q with the loops open, for routines of positions alone.
        references: in the order of the routines and their results.
        safe: for every safe function what it finds, earlier kernels' roundings included.
    """

    inputs: dict[str, FloatArray]
    references: tuple[Reference, ...]
    safe: dict[str, tuple[Reference, ...]]

    def group(self, program: Program, name: str) -> str:
        """The key in `inputs` of an input group of a program."""
        return "q_open" if name == "q" and all(other in ("q", "t", "p") for other, _ in program.inputs) else name


def trial(subject: Subject, seed: int) -> Trial:
    """A random assembled state of the model, and the LLVM kernels' results there.

    Raises:
        AssemblyError: near the home no pose closes the loops away from a singularity.
        InputError: a result there is not finite.
    """
    made = Trial(_inputs(subject, seed), (), {})
    random = np.random.default_rng(seed)
    references, safe = [], {}
    for name, program in subject.programs.items():
        inputs = {group: made.inputs[made.group(program, group)] for group, _ in program.inputs}
        references += _references(subject, name, (name,), inputs, random)
    for face in faces(subject):
        found = _references(subject, f"safe_{face.name}", face.kernels, made.inputs, random)
        safe[face.name] = tuple(reference for reference in found if reference.name in face.outputs)
    return Trial(made.inputs, tuple(references), safe)


def _inputs(subject: Subject, seed: int) -> dict[str, FloatArray]:
    model, random = subject.model, np.random.default_rng(seed)
    state = admissible_states(model, 3, seed)[2]  # the first two are special
    u = random.normal(size=len(model.inputs))
    q_ddot = model.forward_dynamics(state, u)
    found = {
        "q": state.q,
        "q_open": state.q * (1 + _AJAR * random.uniform(-1, 1, len(state.q))),
        "v": state.v,
        "q_dot": model.velocity(state),
        "u": u,
        "v_dot": random.normal(size=len(state.v)),
        "q_ddot": q_ddot,
        "t": np.array([state.t][: int(model.rheonomic)]),
        "p": np.array(model.values),
    }
    number = np.float64 if subject.real == "double" else np.float32
    return {name: np.asarray(values, dtype=number).astype(np.float64) for name, values in found.items()}


def _references(
    subject: Subject, label: str, kernels: Sequence[str], inputs: Mapping[str, FloatArray], random: np.random.Generator
) -> list[Reference]:
    """The results of the last of some kernels that read inputs and what earlier ones found."""
    eps, made = EPSILON[subject.real], list[Reference]()
    known = dict(inputs)
    runs = {name: [np.full(_LANES, x) for x in values] for name, values in inputs.items()}
    for kernel in kernels:
        program = subject.programs[kernel]
        results = _results(subject, program, [known[name] for name, _ in program.inputs])
        found = iter(_disturbed(program, [x for name, _ in program.inputs for x in runs[name]], eps, random))
        made.clear()
        for (name, shape), result in zip(program.outputs, results, strict=True):
            known[name], runs[name] = np.ravel(result), [next(found) for _ in range(prod(shape))]
            if len(known[name]):
                made.append(_reference(subject, (label, name), known[name], runs[name]))
    return made


def _reference(subject: Subject, names: tuple[str, str], values: FloatArray, runs: list[FloatArray]) -> Reference:
    if not np.isfinite(values).all():
        raise InputError(
            f"{names[0]} of {subject.model.mechanism.name!r} finds no finite {names[1]} that code in C could be "
            "compared with. Change the parameters or the home"
        )
    eps, largest = EPSILON[subject.real], float(np.abs(values).max())
    moved = max(float(np.abs(run - value).max()) for run, value in zip(runs, values, strict=True))
    ulp = eps * 2.0 ** float(np.floor(np.log2(largest))) if largest * eps**0.5 > moved else eps
    return Reference(*names, values, ulp, _ULPS + float(np.ceil(_ROUNDED * moved / ulp)))


def _results(subject: Subject, program: Program, groups: list[FloatArray]) -> tuple[FloatArray, ...]:
    """What the LLVM kernel finds; the residual is the first result of the closures."""
    kernels = subject.model.library.kernels
    return kernels[program.name if program.name in kernels else "closure"](*groups)[: len(program.outputs)]


def _disturbed(program: Program, runs: list[FloatArray], eps: float, random: np.random.Generator) -> list[FloatArray]:
    """All results in runs whose every operation is off by up to eps / 2 of its result."""

    def off(values: Any) -> _Disturbed:
        return _Disturbed(values * (1 + eps * random.uniform(-0.5, 0.5, _LANES)), off)

    def function(of: Any) -> Any:
        return lambda x: off(of(x.values)) if isinstance(x, _Disturbed) else of(x)

    inputs = [_Disturbed(run, off) for run in runs]
    with np.errstate(all="ignore"):
        found = program.tape.run(inputs, {"sin": function(np.sin), "cos": function(np.cos), "sqrt": function(np.sqrt)})
    return [x.values if isinstance(x, _Disturbed) else np.full(_LANES, x) for x in found]


class _Disturbed:
    """Numbers, one for each run, whose operations are a little off."""

    def __init__(self, values: FloatArray, off: Any) -> None:
        self.values, self.off = values, off

    def __neg__(self) -> _Disturbed:
        return _Disturbed(-self.values, self.off)

    def __add__(self, other: Any) -> Any:
        return self.off(self.values + getattr(other, "values", other))

    def __radd__(self, other: float) -> Any:
        return self.off(other + self.values)

    def __sub__(self, other: Any) -> Any:
        return self.off(self.values - getattr(other, "values", other))

    def __rsub__(self, other: float) -> Any:
        return self.off(other - self.values)

    def __mul__(self, other: Any) -> Any:
        return self.off(self.values * getattr(other, "values", other))

    def __rmul__(self, other: float) -> Any:
        return self.off(other * self.values)

    def __rtruediv__(self, other: float) -> Any:
        return self.off(other / self.values)
