"""The header and the source file of a model in C."""

from __future__ import annotations

from collections.abc import Sequence

from nullbody import __version__
from nullbody.export.c.face import definition, faces, prototype
from nullbody.export.c.judge import STATUSES, judges, limits, loops, loops_prototypes
from nullbody.export.c.subject import Subject
from nullbody.kernels.c99 import c_constant, c_functions, comment_text
from nullbody.kernels.c_name import identifiers

__all__ = ["header", "source", "title"]

_WIDTH = 110


def title(subject: Subject) -> str:
    """What a file is about, in one line."""
    return comment_text(
        f"{subject.model.mechanism.name}, equations of motion by nullbody {__version__}, {subject.real}"
    )


def header(subject: Subject) -> str:
    """The one header: what goes in and out, parameters, statuses, safe functions, kernels."""
    P, M, kernels = subject.prefix, subject.macro, list(subject.programs.values())
    declarations, _ = c_functions(kernels, subject.kernel_prefix, subject.real)
    parts = [
        _head(subject),
        f"#ifndef {M}_H\n#define {M}_H\n",
        '#ifdef __cplusplus\nextern "C" {\n#endif\n',
        _sizes(subject),
        _places(subject),
        _parameters(subject),
        _statuses(subject),
        _prototypes(subject),
        "/* Kernels: plain straight-line functions. Nothing is checked: use the functions above unless you judge\n"
        f" * delta, spread, doubt and loss yourself. p holds the parameters in the order of {P}_params, matrices lie\n"
        " * row by row, outputs must not overlap inputs. spread = |N|^2, doubt = (|B| / its column lengths)^-2,\n"
        " * loss: what cancels in N^T M N, power: of loads and inputs [W]. */\n",
        declarations,
        f"#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {M}_H */\n",
    ]
    return "\n".join(parts)


def source(subject: Subject) -> str:
    """The source file: kernels first, then what checks them."""
    P, real = subject.prefix, subject.real
    _, definitions = c_functions(list(subject.programs.values()), subject.kernel_prefix, real)
    chosen = faces(subject)
    regular = any(f"{P}_regular(" in definition(subject, face) for face in chosen)
    fields = [f"    p[{k}] = params->{name};" for k, (name, _, _) in enumerate(subject.parameters)]
    packed = fields or ["    (void)params;", f"    p[0] = {c_constant(0.0, real)};"]
    values = [f"    params->{name} = {c_constant(value, real)};" for name, _, value in subject.parameters]
    parts = [
        f"/* {title(subject)}. {P}.h says what everything means. */\n",
        f'#include "{P}.h"\n\n#include <float.h>\n#include <math.h>\n#include <stddef.h>\n',
        '#if defined(__FAST_MATH__)\n#error "the checks need NaN and infinity: compile without -ffast-math"\n#endif\n',
        limits(subject),
        definitions,
        f"static void {P}_packed(const {P}_params *params, {real} *p)\n{{",
        "\n".join(packed) + "\n}\n",
        f"void {P}_default_params({P}_params *params)\n{{",
        "\n".join(values or ["    params->none = 0;"]) + "\n}\n",
        judges(subject, regular),
        *(definition(subject, face) for face in chosen),
        *([loops(subject)] if subject.model.closure_labels else []),
    ]
    return "\n".join(parts)


def _head(subject: Subject) -> str:
    model, mechanism = subject.model, subject.model.mechanism
    lines = [title(subject), ""]
    lines += ["q' = N v + beta, q'' = N v' + gamma, Mr v' + hr = Br u; SI units, angles in radians.", ""]
    for group, meaning in (("q", "all coordinates"), ("v", "independent rates"), ("u", "inputs")):
        entries = [f"{name} [{unit}]" for name, unit in subject.entries(group)]
        lines += _wrapped(f"{group}[{len(entries)}], {meaning}: ", entries)
    lines += ["q_dot, q_ddot are in the order of q, v_dot in that of v."]
    lines += _wrapped(f"Phi[{len(model.closure_labels)}], loop closures: ", model.closure_labels)
    lines += _wrapped(f"lam[{len(model.labels)}], reactions along the rows of A: ", model.labels)
    if model.rheonomic:
        lines += ["t: the time [s], which drivers depend on."]
    if model.given:
        lines += _wrapped("changed parameters: ", [f"{name} = {value!r}" for name, value in model.given.items()])
    lines += ["", f"Generated from mechanism {mechanism.name!r}; do not edit, export again."]
    return "\n".join(["/*", *(f" * {comment_text(line)}".rstrip() for line in lines), " */", ""])


def _sizes(subject: Subject) -> str:
    M, model = subject.macro, subject.model
    rows = (
        ("NQ", len(model.coordinates), "coordinates"),
        ("NV", len(model.independent), "degrees of freedom"),
        ("NU", len(model.inputs), "inputs"),
        ("NC", len(model.labels), "rows of A"),
        ("NP", max(1, len(subject.parameters)), "parameters"),
    )
    return "".join(f"#define {M}_{name} {size} /* {note} */\n" for name, size, note in rows)


def _places(subject: Subject) -> str:
    """Enumerations of the places in q, v and u."""
    made = []
    for group in ("q", "v", "u"):
        entries = subject.entries(group)
        names = identifiers(name for name, _ in entries)
        rows = [
            f"    {subject.prefix}_{group}_{name} = {k}{',' if k + 1 < len(names) else ''} /* {comment_text(unit)} */"
            for k, (name, (_, unit)) in enumerate(zip(names, entries, strict=True))
        ]
        made += [f"/* places in {group} */\nenum\n{{\n" + "\n".join(rows) + "\n};\n"] if rows else []
    return "\n".join(made)


def _parameters(subject: Subject) -> str:
    P = subject.prefix
    rows = []
    for field, parameter, _ in subject.parameters:
        formula = f"; {parameter.default} unless given" if isinstance(parameter.default, str) else ""
        note = f"{parameter.name} [{parameter.unit or '1'}] {parameter.meaning}{formula}"
        rows.append(f"    {subject.real} {field}; /* {comment_text(note)} */")
    rows = rows or ["    int none; /* the mechanism has no parameters */"]
    about = "Parameters. A formula was evaluated when the code was generated: change what follows from a value too."
    return (
        f"/* {about} */\ntypedef struct\n{{\n" + "\n".join(rows) + f"\n}} {P}_params;\n\n"
        f"/* Fill in the values of the exported model. */\nvoid {P}_default_params({P}_params *params);\n"
    )


def _statuses(subject: Subject) -> str:
    P = subject.prefix
    rows = [
        f"    {P}_{name} = {k}{',' if k + 1 < len(STATUSES) else ''} /* {text} */"
        for k, (name, text) in enumerate(STATUSES)
    ]
    return (
        "typedef enum\n{\n" + "\n".join(rows) + f"\n}} {P}_status;\n\n"
        f"/* The meaning of a status as text. */\nconst char *{P}_message({P}_status status);\n"
    )


def _prototypes(subject: Subject) -> str:
    parts = [
        "/* Safe functions: inputs and results are checked. Anything but ok (0) leaves the outputs as they were;\n"
        " * outputs may overlap inputs. That the loops are closed at q is for check_state and close, where there are\n"
        " * loops: the others trust it. */\n"
    ]
    parts += [f"/* {comment_text(face.meaning)} */\n{prototype(subject, face)};\n" for face in faces(subject)]
    if subject.model.closure_labels:
        check, close = loops_prototypes(subject)
        parts += [f"/* Whether all loops are closed at q. */\n{check};\n"]
        parts += [
            "/* Close all loops by Newton's method from a q near by, the independent coordinates held: forward\n"
            f" * kinematics, and what keeps measured coordinates consistent. */\n{close};\n"
        ]
    return "\n".join(parts)


def _wrapped(start: str, entries: Sequence[str]) -> list[str]:
    lines, line = [], start
    for k, entry in enumerate(entries or ["none"]):
        piece = entry + ("," if k + 1 < len(entries) else "")
        if len(line) + len(piece) + 1 > _WIDTH:
            lines.append(line.rstrip())
            line = "    "
        line += f"{piece} "
    return [*lines, line.rstrip()]
