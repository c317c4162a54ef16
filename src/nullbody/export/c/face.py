"""The safe functions in C: they check what goes in and what comes out, and return a status."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from nullbody.export.c.subject import Subject, all_of
from nullbody.kernels.c99 import call_text

__all__ = ["Face", "definition", "faces", "prototype"]


@dataclass(frozen=True)
class Face:
    """One safe function: kernels called one after the other, each reading arguments and what earlier ones found.

    Attributes:
        name: of the function, behind the prefix.
        meaning: equation and units.
        inputs: groups that the caller gives.
        kernels: routines; the first one's measures are judged.
        outputs: what the caller gets.
    """

    name: str
    meaning: str
    inputs: tuple[str, ...]
    kernels: tuple[str, ...]
    outputs: tuple[str, ...]


_FACES = (
    Face("velocity", "q_dot = N v + beta: all rates [m/s, rad/s]", ("q", "v"), ("kinematics",), ("q_dot",)),
    Face(
        "null_space", "N, row by row, and gamma: q_ddot = N v_dot + gamma", ("q", "v"), ("kinematics",), ("N", "gamma")
    ),
    Face(
        "forward_dynamics",
        "q_ddot = N v_dot + gamma with Mr v_dot + hr = Br u: all accelerations [m/s^2, rad/s^2]",
        ("q", "v", "u"),
        ("forward_dynamics",),
        ("q_ddot",),
    ),
    Face(
        "inverse_dynamics",
        "u with Br u = Mr v_dot + hr: inputs for given independent accelerations [N, N m]",
        ("q", "v", "v_dot"),
        ("inverse_dynamics",),
        ("u",),
    ),
    Face(
        "generalized_forces",
        "Qr = Mr v_dot + hr, the forces along v [N, N m], and Br, row by row: Br u = Qr",
        ("q", "v", "v_dot"),
        ("inverse_dynamics",),
        ("Qr", "Br"),
    ),
    Face(
        "reactions",
        "lam with A^T lam = Q - M q_ddot - h, for the motion that u causes [N, N m]",
        ("q", "v", "u"),
        ("forward_dynamics", "reactions"),
        ("lam",),
    ),
    Face("energy", "kinetic and potential energy [J]", ("q", "v"), ("kinematics", "energy"), ("T", "U")),
)


def faces(subject: Subject) -> list[Face]:
    """The safe functions of this model: inverse dynamics only with as many inputs as degrees of freedom."""
    square = len(subject.model.inputs) == len(subject.model.independent)
    return [
        face
        for face in _FACES
        if any(_found(subject, face)[name] for name in face.outputs) and (face.name != "inverse_dynamics" or square)
    ]


def prototype(subject: Subject, face: Face) -> str:
    """The head of a safe function; groups of size 0 are not among its arguments."""
    found = _found(subject, face)
    outputs = [f"{subject.real} *{name}" for name in face.outputs if found[name]]
    return subject.head(face.name, face.inputs, outputs)


def definition(subject: Subject, face: Face) -> str:
    """The text of a safe function."""
    P, found = subject.prefix, _found(subject, face)
    results = [name for name in face.outputs if found[name]]
    first, *later = (subject.call(name, face.inputs) for name in face.kernels)
    lines = [f"{subject.real} p[{subject.macro}_NP];", *subject.arrays(found), f"{P}_status status = {P}_not_finite;"]
    lines += ["", f"{P}_packed(params, p);"]
    lines += _if(subject.finite(face.inputs), [first, f"status = {_verdict(subject, found)};"])
    if face.name == "inverse_dynamics" and not _constant_inputs(subject):
        lines += _if(f"(status == {P}_ok) && ({P}_regular(found_Br) == 0)", [f"status = {P}_singular_inputs;"])
    checks = [f"({P}_finite(found_{name}, {found[name]}) != 0)" for name in results if name != _judged(found)]
    if checks:
        kept = f"({all_of(checks)}) ? {P}_ok : {P}_not_finite"
        lines += _if(f"status == {P}_ok", [*later, f"status = {kept};"])
    lines += _if(f"status == {P}_ok", [f"{P}_copied(found_{name}, {found[name]}, {name});" for name in results])
    return "\n".join([prototype(subject, face), "{", *_indented([*lines, "return status;"]), "}", ""])


def _found(subject: Subject, face: Face) -> dict[str, int]:
    """Sizes of all that the kernels of a face find."""
    return {key: prod(shape) for name in face.kernels for key, shape in subject.programs[name].outputs}


def _verdict(subject: Subject, found: dict[str, int]) -> str:
    P, measures = subject.prefix, "found_spread[0], found_doubt[0]"
    result = _judged(found)
    if result is None:
        return f"{P}_judged_space({measures}, {subject.macro}_SPREAD)"
    finite = f"{P}_finite(found_{result}, {found[result]})"
    return call_text(f"{P}_judged_dynamics", [*measures.split(", "), "found_loss[0]", finite], "        ")


def _judged(found: dict[str, int]) -> str | None:
    """The result that is judged with the measures: q_ddot or Qr."""
    return next(key for key in found if found[key]) if "loss" in found else None


def _constant_inputs(subject: Subject) -> bool:
    """Whether Br is the same everywhere: then u exists, or derive has refused."""
    program = subject.programs["inverse_dynamics"]
    refs = iter(program.tape.outputs)
    parts = {key: [next(refs) for _ in range(prod(shape))] for key, shape in program.outputs}
    return all(program.tape.code[ref >> 1][0] == "const" for ref in parts["Br"])


def _if(condition: str, lines: Iterable[str]) -> list[str]:
    return [f"if ({condition})", "{", *_indented(lines), "}"]


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"    {line}".rstrip() for line in lines]
