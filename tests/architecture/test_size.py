"""Small pieces: length of files and functions, docstrings, nothing left to do, no text turned into code."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.architecture.source import ROOT, SRC, parsed, place

FILE_LINES = 400
FUNCTION_LINES = 60
LEFTOVER = re.compile(r"\b(T[O]DO|F[I]XME|X[X]X)\b")  # spelled so that it does not find itself
TEXT_TO_CODE = {"eval", "exec", "sympify"}

Found = Iterator[str]


def long_files(folder: Path) -> Found:
    for file, _ in parsed(folder):
        count = len(file.read_text(encoding="utf-8").splitlines())
        if count > FILE_LINES:
            yield f"{place(file, count)}: {count} lines, the limit is {FILE_LINES}"


def long_functions(folder: Path) -> Found:
    for file, tree in parsed(folder):
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                count = (node.end_lineno or node.lineno) - node.lineno + 1
                if count > FUNCTION_LINES:
                    yield f"{place(file, node.lineno)}: {node.name} has {count} lines, the limit is {FUNCTION_LINES}"


def undocumented(folder: Path) -> Found:
    for file, tree in parsed(folder):
        for node in tree.body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                public = not node.name.startswith("_")
                if public and not ast.get_docstring(node):
                    yield f"{place(file, node.lineno)}: {node.name} has no docstring"


def leftovers(folder: Path) -> Found:
    for file, _ in parsed(folder):
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            if LEFTOVER.search(line):
                yield f"{place(file, number)}: {line.strip()}"


def text_to_code(folder: Path) -> Found:
    for file, tree in parsed(folder):
        for node in ast.walk(tree):
            match node:
                case ast.Call(func=ast.Name(id=name)) if name in TEXT_TO_CODE:
                    yield f"{place(file, node.lineno)}: {name}(...)"
                case ast.Call(func=ast.Attribute(attr="sympify")):
                    yield f"{place(file, node.lineno)}: sympify(...)"


@pytest.mark.parametrize("rule", [long_files, long_functions, undocumented, leftovers, text_to_code])
def test_source_keeps_the_rule(rule) -> None:
    found = list(rule(SRC))
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize("rule", [long_files, leftovers])
def test_tests_keep_the_rule(rule) -> None:
    found = list(rule(ROOT / "tests"))
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize(
    ("rule", "text", "line"),
    [
        (long_files, "x = 1\n" * (FILE_LINES + 1), FILE_LINES + 1),
        (long_functions, "class A:\n    def f(self):\n" + "        x = 1\n" * FUNCTION_LINES, 2),
        (undocumented, "import re\ndef f():\n    return 1\n", 2),
        (leftovers, "x = 1\n# TO" + "DO: more\n", 2),
        (text_to_code, "def f(x):\n    return eval(x)\n", 2),
        (text_to_code, "import sympy\nsympy.sympify('x')\n", 2),
    ],
)
def test_planted_violation_is_named(tmp_path: Path, rule, text: str, line: int) -> None:
    file = tmp_path / "planted.py"
    file.write_text(text)
    (message,) = rule(tmp_path)
    assert message.startswith(f"{file}:{line}: ")
