"""Models that the tests of this folder share."""

from __future__ import annotations

import pytest

from nullbody import build, derive
from nullbody.catalog import three_prs


@pytest.fixture(scope="session")
def robot():
    return build(derive(three_prs(), ("s1", "s2", "s3")))


@pytest.fixture(scope="session")
def general(robot):
    return robot.replace(Ixx=0.02, Iyy=0.03, Izz=0.025, ms=0.3, l=0.6, b=0.25)
