"""Settings of the whole test run: a kernel cache of its own, no display, repeatable random examples."""

from __future__ import annotations

import os
import shutil
import tempfile

import pytest
from hypothesis import settings

settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


def pytest_configure(config: pytest.Config) -> None:
    """Point the kernel cache at a folder of this run, before any test module is imported; workers share it."""
    os.environ["MPLBACKEND"] = "Agg"
    if not hasattr(config, "workerinput"):
        os.environ["NULLBODY_CACHE"] = tempfile.mkdtemp(prefix="nullbody-test-")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove that folder."""
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ.pop("NULLBODY_CACHE"), ignore_errors=True)
