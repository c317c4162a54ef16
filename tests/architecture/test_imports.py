"""`import nullbody` loads none of the heavy libraries."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ("scipy", "sympy", "matplotlib", "xarray", "dask", "llvmlite", "mujoco", "pinocchio", "pandas")


def loaded_by(statement: str) -> set[str]:
    """The heavy libraries that a fresh interpreter has loaded after a statement."""
    program = f"{statement}\nimport sys\nprint(*[name for name in {HEAVY!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_import_is_light() -> None:
    assert loaded_by("import nullbody; dir(nullbody)") == set()


@pytest.mark.parametrize("library", ["scipy", "matplotlib"])
def test_the_probe_sees_what_is_loaded(library: str) -> None:
    assert library in loaded_by(f"import {library}")
