"""Imports point down: every import in src/nullbody, lazy and TYPE_CHECKING ones too, against the table of layers."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.architecture.source import SRC, parsed, place

LAYERS = (
    ("errors", "typing", "tolerances"),
    ("expr",),
    ("kernels",),
    ("mechanism", "nullspace"),
    ("equations", "catalog", "formats"),
    ("model",),
    ("kinematics",),
    ("simulate",),
    ("control", "analysis", "study", "verify"),
    ("bench",),
    ("report", "viewer", "export"),
    ("cli",),
    ("__main__",),  # `python -m nullbody`: one call of the command line
)
LAYER = {name: number for number, names in enumerate(LAYERS) for name in names}
FACE = "__init__"  # nullbody/__init__.py may import anything, and nothing may import it


def part_of(dotted: str) -> str:
    """The package or module directly below nullbody that a dotted name belongs to."""
    parts = dotted.split(".")
    return parts[1] if len(parts) > 1 else FACE


def absolute(node: ast.ImportFrom, file: Path, top: Path) -> str:
    """The module that a `from` statement names, relative dots resolved."""
    if not node.level:
        return node.module or ""
    folder = ("nullbody", *file.relative_to(top).parts[:-1])
    base = folder[: len(folder) - node.level + 1]
    return ".".join((*base, node.module) if node.module else base)


def targets(node: ast.AST, file: Path, top: Path) -> list[str]:
    """The dotted names that a node imports; `import_module` and `__import__` of a literal count."""
    match node:
        case ast.Import(names=names):
            return [alias.name for alias in names]
        case ast.ImportFrom(names=names):
            module = absolute(node, file, top)
            whole = module == "nullbody"  # then the names are parts; the version is a mere number
            return [f"nullbody.{a.name}" for a in names if a.name != "__version__"] if whole else [module]
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name), args=[ast.Constant(value=str(dotted)), *_]):
            return [dotted] if name in ("import_module", "__import__") else []
    return []


def judge(source: str, target: str) -> str | None:
    """Why `source` may not import `target`, or nothing."""
    if source == target:
        return None
    if source not in LAYER:
        return f"{source} has no layer: add it to the table"
    if target not in LAYER:
        return f"{source} imports {target}, the public face or a part without a layer"
    gap = LAYER[target] - LAYER[source]
    if gap < 0:
        return None
    way = "up" if gap else "sideways"
    return f"{source} (layer {LAYER[source]}) imports {target} (layer {LAYER[target]}): {way}"


def violations(top: Path) -> Iterator[str]:
    """`file:line: why` for every import below `top`, a nullbody package folder, that does not point down."""
    for file, tree in parsed(top):
        source = file.relative_to(top).parts[0].removesuffix(".py")
        if source == FACE:
            continue
        for node in ast.walk(tree):
            for dotted in targets(node, file, top):
                if dotted.split(".")[0] == "nullbody" and (why := judge(source, part_of(dotted))):
                    yield f"{place(file, node.lineno)}: {why}"


def test_imports_point_down() -> None:
    found = list(violations(SRC))
    assert not found, "\n" + "\n".join(found)


def test_every_part_has_a_layer() -> None:
    parts = {path.stem for path in SRC.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
    assert parts - {FACE} <= set(LAYER)


@pytest.mark.parametrize(
    ("statement", "way"),
    [
        ("from nullbody.simulate.step import Step", "up"),
        ("def f():\n    from nullbody import simulate", "up"),
        ("def f():\n    import nullbody.simulate.step as step", "up"),
        ("if TYPE_CHECKING:\n    from ..simulate import Trajectory", "up"),
        ("from nullbody.mechanism import Mechanism", "sideways"),
        ("import_module('nullbody.cli')", "up"),
        ("import nullbody", "face"),
        ("from nullbody import Model", "face"),
    ],
)
def test_planted_violation_is_named(tmp_path: Path, statement: str, way: str) -> None:
    file = tmp_path / "nullspace" / "pivot.py"
    file.parent.mkdir()
    file.write_text("\n" + statement + "\n")
    (message,) = violations(tmp_path)
    assert message.startswith(f"{file}:{1 + len(statement.splitlines())}: ")
    assert way in message


@pytest.mark.parametrize(
    "statement",
    [
        "from nullbody.expr import Graph",
        "from . import minor",
        "from nullbody import __version__, errors",
        "from .minor import f",
        "import numpy",
    ],
)
def test_allowed_import_passes(tmp_path: Path, statement: str) -> None:
    file = tmp_path / "nullspace" / "pivot.py"
    file.parent.mkdir()
    file.write_text(statement + "\n")
    assert list(violations(tmp_path)) == []


def test_file_without_layer_is_named(tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("import nullbody.expr\n")
    assert list(violations(tmp_path)) == [f"{tmp_path / 'helper.py'}:1: helper has no layer: add it to the table"]
