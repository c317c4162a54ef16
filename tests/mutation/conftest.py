"""Shared by the mutation tests: those of the 3-PRS robot."""

from __future__ import annotations

import pytest

from nullbody.catalog import three_prs
from nullbody.equations import Equations, derive


@pytest.fixture(scope="session")
def three_prs_equations() -> Equations:
    """The equations of the 3-PRS robot, independent in its sliders."""
    return derive(three_prs(), ("s1", "s2", "s3"))
