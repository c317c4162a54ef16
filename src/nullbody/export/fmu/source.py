"""The C sources of a unit: printed kernels, tables of the mechanism, and the files that all units share."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from math import prod

from nullbody import tolerances
from nullbody.equations.scalar import ParameterScalars
from nullbody.errors import InputError
from nullbody.export.fmu.variables import DRIFT, TOLERANCE, Unit
from nullbody.expr import Expr, Graph, Tape
from nullbody.expr.parse import names_in
from nullbody.kernels import Program
from nullbody.kernels.c99 import c_constant, c_functions
from nullbody.mechanism import Mechanism
from nullbody.model.build import programs
from nullbody.model.scale import coordinate_scales

__all__ = ["sources"]

_LARGEST = 1.7976931348623157e308  # stands for infinity where an input has no limit

#: The outputs of the routines that core.h reads.
_READ: Mapping[str, tuple[str, ...]] = {
    "closure": ("Phi", "A"),
    "redundant": ("Phi",),
    "facing": ("cosines",),
    "closing": ("correction", "delta"),
    "forward_dynamics": ("q_ddot", "q_dot", "delta", "spread", "doubt", "loss", "power"),
    "energy": ("T", "U"),
    "reactions": ("lam",),
    "parameters": ("p", "low", "high"),
}
#: The routines that each chart has its own of: core.h names the chart.
_OF_CHART = ("closing", "forward_dynamics", "kinematics", "reactions")
_GROUPS = ("q", "v", "q_dot", "u", "q_ddot", "t", "p")
_SHARED = {
    2: ("core.h", "fmi2.c", "fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("core.h", "fmi3.c", "fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}


def sources(unit: Unit, fmi: int) -> tuple[dict[str, str], str]:
    """The C files by name, fmi<2|3>.c and kernels.c to be compiled, and the unit's token (GUID).

    Raises:
        InputError: a routine does not give what the unit needs.
    """
    chosen = _programs(unit)
    prefix = f"{unit.identifier}_nb"
    declarations, definitions = c_functions([*chosen, *_others(unit, chosen)], prefix)
    parts = {
        "kernels.h": f"#ifndef NULLBODY_KERNELS_H\n#define NULLBODY_KERNELS_H\n\n{declarations}\n#endif\n",
        "kernels.c": f'#include <math.h>\n\n#include "kernels.h"\n\n{definitions}',
        **{name: _shared(name) for name in _SHARED[fmi]},
    }
    tables = "\n".join([*_sizes(unit, chosen), *_tables(unit), *_adapters(chosen, prefix, len(unit.charts))])
    described = [(v.name, v.reference, v.unit, v.causality, v.initial, v.start) for v in unit.variables]
    content = json.dumps([parts, tables, described, unit.identifier])
    token = f"{{{hashlib.sha256(content.encode()).hexdigest()[:32]}}}"
    parts["model.h"] = (
        f"/* Made by nullbody for the mechanism {_commented(unit.model.mechanism.name)}. */\n\n"
        f'#ifndef NULLBODY_MODEL_H\n#define NULLBODY_MODEL_H\n\n#include "kernels.h"\n\n'
        f'#define TOKEN "{token}"\n{tables}\n#endif\n'
    )
    return parts, token


def _programs(unit: Unit) -> list[Program]:
    """The routines that the unit evaluates, and the one for parameters."""
    found = {program.name: program for program in programs(unit.equations)}
    found["parameters"] = _parameters(unit.model.mechanism, unit.follows)
    if not unit.reactions:
        found["reactions"] = Program("reactions", (), (("lam", (0,)),), Tape.of([], []))
    read = {**_READ, "kinematics": ("N", "doubt")} if len(unit.charts) > 1 else _READ
    for name, wanted in read.items():
        given = [] if name not in found else [output for output, _ in found[name].outputs]
        if missing := [output for output in wanted if output not in given]:
            raise InputError(f"routine {name!r} of these equations does not give {', '.join(missing)}")
    return [found[name] for name in read]


def _others(unit: Unit, chosen: Sequence[Program]) -> list[Program]:
    """The routines of the further charts, numbered from 1: the same inputs and outputs as those of the first.

    Raises:
        InputError: they are not.
    """
    firsts = {program.name: program for program in chosen if program.name in _OF_CHART}
    found = []
    for k, equations in enumerate(unit.charts[1:], 1):
        for program in programs(equations):
            first = firsts.get(program.name)
            if first is None or not first.tape.outputs:
                continue
            if (program.inputs, program.outputs) != (first.inputs, first.outputs):
                raise InputError(f"the chart {', '.join(equations.independent)} has another routine {program.name!r}")
            found.append(replace(program, name=f"{program.name}_{k}"))
    return found


def _parameters(mechanism: Mechanism, follows: Sequence[bool]) -> Program:
    """(p) -> (p with formulas evaluated, least and largest inputs)."""
    names = tuple(parameter.name for parameter in mechanism.parameters)
    scalars = ParameterScalars(Graph(), names)
    waiting = {p.name: p.default for p, following in zip(mechanism.parameters, follows, strict=True) if following}
    settled: dict[str, Expr] = {name: scalars.graph.symbol(name) for name in names if name not in waiting}
    while waiting:
        for name in [name for name, default in waiting.items() if names_in(default) <= settled.keys()]:
            settled[name] = scalars.moving(waiting.pop(name), settled)
    limits = [actuator.limits or (-_LARGEST, _LARGEST) for actuator in mechanism.actuators]
    sides = [[scalars.moving(pair[side], settled) for pair in limits] for side in (0, 1)]
    results = [*(settled[name] for name in names), *sides[0], *sides[1]]
    outputs = (("p", (len(names),)), ("low", (len(limits),)), ("high", (len(limits),)))
    return Program("parameters", (("p", len(names)),), outputs, Tape.of(results, names))


@cache
def _shared(name: str) -> str:
    return files("nullbody.export.fmu").joinpath("c", name).read_text(encoding="utf-8")


def _sizes(unit: Unit, chosen: Sequence[Program]) -> list[str]:
    """Sizes, value references and tolerances as macros."""
    model = unit.model
    shapes = {program.name: dict(program.outputs) for program in chosen}
    sizes = {
        "NQ": len(model.coordinates),
        "NV": len(model.independent),
        "NU": len(model.inputs),
        "NP": len(model.values),
        "NPHI": len(model.closure_labels),
        "NREDUNDANT": prod(shapes["redundant"]["Phi"]),
        "NFACING": len(model.facing),
        "NREACTIONS": unit.groups["REACTION"].count,
        "NCHARTS": len(unit.charts),
        "NEWTON_STEPS": tolerances.NEWTON_STEPS,
        **{f"VR_{name}": f"{group.first}u" for name, group in unit.groups.items()},
    }
    reals = {
        "CLOSED": tolerances.CLOSED,
        "CLOSED_STEP": tolerances.CLOSED_STEP,
        "GIVEN_CLOSED": tolerances.GIVEN_CLOSED,
        "LARGE_SPREAD": tolerances.LARGE_SPREAD,
        "REGULAR_DOUBT": tolerances.REGULAR_DOUBT,
        "REGULAR_LOSS": tolerances.REGULAR_LOSS,
        "SIMULATED_SPREAD": tolerances.SIMULATED_SPREAD,
        "SWITCH_DOUBT": tolerances.SWITCH_DOUBT,
        "SWITCH_SPREAD": tolerances.SWITCH_SPREAD,
        "TOLERANCE": TOLERANCE,
        "DRIFT": DRIFT,
        "START_T": float(unit.state.t),
    }
    macros = [f"#define {name} {value}" for name, value in sizes.items()]
    macros += [f"#define {name} {c_constant(value)}" for name, value in reals.items()]
    macros.append("#define SIZE(n) ((n) > 0 ? (n) : 1)")
    return macros


def _tables(unit: Unit) -> list[str]:
    """Names, the start, and what acts where."""
    model = unit.model
    signs = {"any": 0, "positive": 1, "non-negative": 2}
    whole = {
        "ACTUATED": model.actuated_columns,
        "SIGN": [signs[parameter.sign] for parameter in model.mechanism.parameters],
        "FOLLOWS": [int(following) for following in unit.follows],
    }
    scales = coordinate_scales(model, model.all_rows(unit.state.q, unit.state.t)[1])
    reals = {
        "SCALE": scales.tolist(),
        "START_Q": unit.state.q.tolist(),
        "START_V": unit.state.v.tolist(),
        "START_P": list(model.values),
    }
    texts = {
        "PARAMETER_NAMES": [parameter.name for parameter in model.mechanism.parameters],
        "CLOSURE_NAMES": list(model.closure_labels),
        "FACING_NAMES": list(model.facing),
        "INDEPENDENT_NAMES": [", ".join(equations.independent) for equations in unit.charts],
    }
    lines = [
        f"#define MODEL_IDENTIFIER {_text(unit.identifier)}",
        "",
        f"static const int INDEPENDENT[NCHARTS][SIZE(NV)] = {{{', '.join(_columns(unit))}}};",
    ]
    lines += [_table("int", name, [str(value) for value in values], "0") for name, values in whole.items()]
    lines += [_table("double", name, [c_constant(value) for value in values], "0.0") for name, values in reals.items()]
    lines += [_table("char *const", name, [_text(value) for value in values], '""') for name, values in texts.items()]
    return [*lines, ""]


def _table(kind: str, name: str, values: Sequence[str], filler: str) -> str:
    """A constant array; C has none without elements."""
    body = ",\n    ".join(values or [filler])
    return f"static const {kind} {name}[{len(values) or 1}] = {{\n    {body},\n}};"


def _columns(unit: Unit) -> list[str]:
    """For each chart the places of its independent coordinates, as C."""
    places = [[str(unit.model.coordinates.index(name)) for name in e.independent] for e in unit.charts]
    return [f"{{{', '.join(columns or ['0'])}}}" for columns in places]


def _adapters(chosen: Sequence[Program], prefix: str, charts: int) -> list[str]:
    """For each program a struct of its outputs and a function that fills it, by the names of groups."""
    lines = ["/* What kernels read; each takes what it needs. */", "struct At {"]
    lines += [f"    const double *{group};" for group in _GROUPS]
    lines += ["};"]
    for program in chosen:
        unknown = [group for group, _ in program.inputs if group not in _GROUPS]
        if unknown:
            raise InputError(f"routine {program.name!r} needs {', '.join(unknown)}, which a unit does not have")
        lines += ["", f"struct {program.name}_values {{"]
        lines += [f"    double {_place(name, shape)};" for name, shape in program.outputs]
        own = program.name in _OF_CHART
        arguments = f"{'int chart, ' * own}const struct At *at, struct {program.name}_values *out"
        lines += ["};", "", f"static inline void eval_{program.name}({arguments})", "{"]
        inputs = [f"at->{group}" for group, _ in program.inputs]
        outputs = [f"out->{name}" if shape else f"&out->{name}" for name, shape in program.outputs]
        call = f"({', '.join([*inputs, *outputs])});"
        lines += ["    (void)chart;"] * own + ["    (void)at;"] * (not inputs)
        for k in range(1, charts if own and program.tape.outputs else 1):
            lines += [
                f"    if (chart == {k}) {{",
                f"        {prefix}_{program.name}_{k}{call}",
                "        return;",
                "    }",
            ]
        lines += [f"    {prefix}_{program.name}{call}", "}"]
    return lines


def _place(name: str, shape: tuple[int, ...]) -> str:
    return f"{name}[{prod(shape) or 1}]" if shape else name


def _text(text: str) -> str:
    """A C string; % and #, which loggers read as signs of their own, become _."""
    plain = "".join("_" if sign in "%#" or ord(sign) < 32 else sign for sign in text)
    escaped = plain.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _commented(text: str) -> str:
    """A text that cannot end a comment."""
    return _text(text).replace("*/", "* /").replace("/*", "/ *")
