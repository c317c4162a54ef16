"""docs/api.md from the signatures and docstrings of everything that a package names in `__all__`."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from types import ModuleType

import nullbody
from nullbody import errors
from tests.architecture.source import ROOT

__all__ = ["PACKAGES", "api_page"]

#: In the order in which they are used; what a package names in `__all__` is public, but for the names given here.
PACKAGES: dict[str, set[str]] = {
    "catalog": {"closed_form_of"},
    "mechanism": {"AbstractLoopJoint", "AbstractTreeJoint", "Motion", "Pose"},
    "formats": {"RigidFrame", "Step", "frame", "loop_points", "mass_properties", "number", "steps", "triple"},
    "equations": {"Routine", "flat", "shape"},
    "model": {"programs", "vector"},
    "kinematics": set(),
    "simulate": set(),
    "control": set(),
    "verify": set(),
    "export": {"check_target"},
    "report": {"Check", "Figure", "Listing", "Section", "Table", "Text", "Verdict", "sections"},
    "nullspace": set(),
    "expr": {"Tape"},
}

_HEAD = """# The public face

Written by `make regenerate` from signatures and docstrings; a test compares. Units stand in square brackets,
SI throughout. Symbols are those of the [glossary](glossary.md), numbers in square brackets such as [42] the paper's
equations ([theory](theory.md)). What each error means: [troubleshooting](troubleshooting.md).

"""
_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns):\n((?:(?:    .*)?\n?)*)", re.M)
_TITLES = {"Args": "Arguments", "Attributes": "Holds", "Raises": "Errors", "Returns": "Returns"}
_SHOWN = ("__call__", "__getitem__", "__str__")
_WIDTH = 110


def api_page() -> dict[Path, str]:
    """The page and what belongs into it."""
    parts = [_HEAD, *_contents(), "\n## Errors\n\n", *_error_table()]
    for name in PACKAGES:
        parts += _package(name, import_module(f"nullbody.{name}"))
    return {ROOT / "docs" / "api.md": "".join(parts).rstrip() + "\n"}


def _contents() -> Iterator[str]:
    for name in PACKAGES:
        package = import_module(f"nullbody.{name}")
        anchor = f"nullbody{name}"
        yield f"- [nullbody.{name}](#{anchor}): {', '.join(f'`{item}`' for item in _public(name, package))}\n"


def _public(name: str, package: ModuleType) -> list[str]:
    return [item for item in package.__all__ if item not in PACKAGES[name]]


def _error_table() -> Iterator[str]:
    yield "All of them are in `nullbody`.\n\n| class | is also | meaning |\n|---|---|---|\n"
    for name in errors.__all__:
        kind = getattr(errors, name)
        bases = ", ".join(f"`{base.__name__}`" for base in kind.__bases__)
        yield f"| `{name}` | {bases} | {_cell(_first(kind))} |\n"


def _package(name: str, package: ModuleType) -> Iterator[str]:
    summary = (inspect.getdoc(package) or "").splitlines()[0]
    yield f"\n## {package.__name__}\n\n{_prose(summary)}\n"
    for item in _public(name, package):
        value = getattr(package, item)
        if isinstance(value, type) or inspect.isroutine(value):
            yield _entry(package, item, value)


def _entry(package: ModuleType, name: str, value: object) -> str:
    path = f"nullbody.{name}" if getattr(nullbody, name, None) is value else f"{package.__name__}.{name}"
    lines = [f"\n### {path}\n\n```py\n{_signature(name, value)}\n```\n\n", _body(inspect.getdoc(value) or "")]
    if isinstance(value, type):
        lines += _methods(value)
    return "".join(lines)


def _signature(name: str, value: object) -> str:
    if isinstance(value, type) and (inspect.isabstract(value) or issubclass(value, Enum)):
        return f"class {name}  # {'an Enum' if issubclass(value, Enum) else 'abstract'}"
    try:
        signature = inspect.signature(value)  # type: ignore[arg-type]
    except ValueError:
        return name
    shown: list[str] = []
    for parameter in signature.parameters.values():
        if parameter.name == "self" or parameter.name.startswith("_"):
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and not any(part.startswith("*") for part in shown):
            shown.append("*")
        shown.append(_parameter(parameter))
    result = signature.return_annotation
    end = f") -> {result}" if isinstance(result, str) and not isinstance(value, type) else ")"
    line = f"{name}({', '.join(shown)}{end}"
    return line if len(line) <= _WIDTH else f"{name}(\n" + "".join(f"    {part},\n" for part in shown) + end


def _parameter(parameter: inspect.Parameter) -> str:
    stars = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    text = stars + parameter.name
    if isinstance(parameter.annotation, str):
        text += f": {parameter.annotation}"
    default = parameter.default
    if default is inspect.Parameter.empty:
        return text
    plain = default is None or isinstance(default, int | float | str | tuple)
    return f"{text} = {default!r}" if plain else f"{text} = ..."


def _body(text: str) -> str:
    """A docstring: prose, indented equations as they are, sections as lists."""
    head = _SECTION.split(text + "\n")[0].strip("\n")
    parts = [f"{_paragraphs(head)}\n"]
    for section in _SECTION.finditer(text + "\n"):
        parts.append(f"\n{_TITLES[section[1]]}:\n\n{_items(section[2])}")
    return "".join(parts)


def _paragraphs(text: str) -> str:
    done = []
    for paragraph in re.split(r"\n\s*\n", text):
        plain = all(line.startswith("    ") for line in paragraph.splitlines())
        done.append(f"```text\n{textwrap.dedent(paragraph)}\n```" if plain and paragraph else _prose(paragraph))
    return "\n\n".join(done)


def _items(text: str) -> str:
    """`name: meaning` entries, continued on deeper lines, as a list."""
    items: list[str] = []
    for line in textwrap.dedent(text).splitlines():
        if line.startswith(" ") and items:
            items[-1] += f" {line.strip()}"
        elif line.strip():
            items.append(line.strip())
    done = []
    for item in items:
        names, colon, meaning = item.partition(": ")
        listed = re.fullmatch(r"\w+(, \w+)*", names) and colon
        done.append(f"- `{names}`: {_prose(meaning)}\n" if listed else f"- {_prose(item)}\n")
    return "".join(done)


def _methods(kind: type) -> Iterator[str]:
    rows = []
    members = {name: value for base in _told_by(kind) for name, value in vars(base).items()}
    for name, value in members.items():
        if (name.startswith("_") and name not in _SHOWN) or not inspect.getdoc(value):
            continue
        function = value.__func__ if isinstance(value, staticmethod | classmethod) else value
        call = _signature(name, function).rpartition(" -> ")[0] or name if inspect.isfunction(function) else name
        if inspect.isfunction(function) or type(value).__name__ in ("property", "cached_property"):
            rows.append(f"| `{_cell(_bare(call), code=True)}` | {_cell(_first(value))} | {_raised(value)} |\n")
    if issubclass(kind, Enum):
        rows += [f"| `{member.name}` | {_cell(str(member.value))} |  |\n" for member in kind]
    if rows:
        yield "\n| member | what | errors |\n|---|---|---|\n"
        yield from rows


def _told_by(kind: type) -> list[type]:
    """The class; of the builder also the parts that it is put together from."""
    parts = [base for base in kind.__mro__[1:] if base.__module__.startswith("nullbody.mechanism.builder.")]
    return [kind, *parts[:-1]] if parts else [kind]


def _bare(call: str) -> str:
    """A signature on one line without its annotations."""
    flat = re.sub(r"\s+", " ", call).replace("( ", "(").replace(", )", ")")
    return re.sub(r": (?:[^,=()\[\]]|\[[^\]]*\])+(?= =|,|\))", "", flat)


def _first(value: object) -> str:
    """The first paragraph of a docstring, on one line."""
    return " ".join(re.split(r"\n\s*\n", inspect.getdoc(value) or "")[0].split())


def _raised(value: object) -> str:
    found = re.search(r"^Raises:\n((?:    .*\n?|\n)*)", inspect.getdoc(value) or "", re.M)
    names = [name for name in errors.__all__ if found and re.search(rf"\b{name}\b", found[1])]
    return ", ".join(f"`{name}`" for name in names)


def _prose(text: str) -> str:
    """Text with the signs that Markdown would take for its own escaped, outside backticks."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(part if part.startswith("`") else re.sub(r"([*_<>\\~])", r"\\\1", part) for part in parts)


def _cell(text: str, *, code: bool = False) -> str:
    return (text if code else _prose(text)).replace("|", "\\|")
