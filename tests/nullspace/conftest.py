"""Shared by the tests of the null space: the robot's constraint Jacobian."""

from __future__ import annotations

from typing import Any

import pytest

from nullbody.catalog import three_prs
from nullbody.equations import derive


@pytest.fixture(scope="session")
def three_prs_jacobian() -> list[list[Any]]:
    """A of the 3-PRS robot, 9 x 12 expressions of one graph."""
    return [list(row) for row in derive(three_prs())["A"]]
