"""The public face: sorted, complete, documented, and the same for people and type checkers."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from types import ModuleType

import pytest

import nullbody
from tests.architecture.source import SRC


def test_names_are_sorted_and_unique() -> None:
    assert nullbody.__all__ == sorted(set(nullbody.__all__))
    assert dir(nullbody) == nullbody.__all__


@pytest.mark.parametrize("name", nullbody.__all__)
def test_name_exists_and_is_documented(name: str) -> None:
    value = getattr(nullbody, name)
    if name != "__version__":
        assert inspect.getdoc(value)


def test_type_checkers_see_the_same_names() -> None:
    """Names imported in __init__.py, at run time or under TYPE_CHECKING, against `__all__`."""
    tree = ast.parse((SRC / "__init__.py").read_text(encoding="utf-8"))
    froms = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    ours = [node for node in froms if (node.module or "").split(".")[0] == "nullbody"]
    seen = {alias.name for node in ours for alias in node.names}
    assert seen | {"__version__"} == set(nullbody.__all__)


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'simulat'"):
        _ = nullbody.simulat


@pytest.mark.parametrize("first", ["import nullbody.simulate", "from nullbody.simulate import Trajectory", "pass"])
def test_simulate_is_the_function_whoever_imports_first(first: str) -> None:
    """The package `simulate` has the name of its function; importing the package must not hide the function."""
    program = f"{first}\nimport nullbody\nprint(callable(nullbody.simulate))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "True"


@pytest.mark.parametrize("name", ["catalog", "control", "export", "nullspace", "report", "verify"])
def test_package_is_an_attribute(name: str) -> None:
    assert isinstance(getattr(nullbody, name), ModuleType)
