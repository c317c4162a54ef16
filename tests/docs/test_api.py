"""docs/api.md is what the signatures and docstrings say."""

from __future__ import annotations

import nullbody
from tests.architecture.source import ROOT
from tests.docs.api import PACKAGES, api_page


def test_page_is_up_to_date() -> None:
    for path, text in api_page().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.relative_to(ROOT)} is old: run `make regenerate`"


def test_page_has_every_public_name() -> None:
    (text,) = api_page().values()
    for name in set(nullbody.__all__) - {"__version__", *PACKAGES}:
        assert f"nullbody.{name}\n" in text or f"| `{name}` |" in text, f"{name} is missing"
