"""docs/catalog.md and its pictures are what the catalog says."""

from __future__ import annotations

import pytest

from nullbody.catalog import ENTRIES, MODELS
from tests.architecture.source import ROOT
from tests.docs.catalog import IMAGES, catalog_page

PNG = b"\x89PNG\r\n\x1a\n"


def test_page_is_up_to_date() -> None:
    for path, text in catalog_page().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.relative_to(ROOT)} is old: run `make regenerate`"


def test_every_mechanism_has_an_entry() -> None:
    assert sorted(ENTRIES) == sorted(MODELS)


@pytest.mark.parametrize("name", ENTRIES)
def test_every_entry_has_its_picture(name: str) -> None:
    """Drawn by `make pictures`, at a size that a page can show."""
    data = (IMAGES / ENTRIES[name].picture).read_bytes()
    width, height = int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    assert data.startswith(PNG)
    assert 800 <= width <= 2000
    assert 600 <= height <= 1500
