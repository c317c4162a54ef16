"""What the catalog says about its mechanisms."""

from __future__ import annotations

import pytest

from nullbody import UnknownName, catalog


def test_describe() -> None:
    entry = catalog.describe("delta")
    assert (entry.title, entry.degrees_of_freedom, entry.task) == ("Delta robot", 3, ("x", "y", "z"))
    assert entry.picture == "delta.png"
    with pytest.raises(UnknownName, match="no model in the catalog 'detla'; did you mean 'delta'"):
        catalog.describe("detla")


@pytest.mark.parametrize("name", catalog.MODELS)
def test_entry_agrees_with_the_mechanism(name: str) -> None:
    entry, mechanism = catalog.ENTRIES[name], catalog.MODELS[name](**catalog.ENTRIES[name].arguments)
    assert entry.name == mechanism.name == name
    assert entry.about.endswith(".")
    assert entry.source
    assert entry.mobility
    assert entry.group in ("robot", "linkage", "benchmark")
    assert not set(entry.pose) - set(mechanism.coordinates)


@pytest.mark.parametrize("name", catalog.MODELS)
def test_names_of_the_issue(name: str) -> None:
    assert getattr(catalog, name) is catalog.MODELS[name]
