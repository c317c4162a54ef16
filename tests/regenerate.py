"""Rewrite the golden files that tests compare with: `python -m tests.regenerate`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.cli.help import help_texts
from tests.docs.api import api_page
from tests.docs.catalog import catalog_page
from tests.docs.page import page_texts
from tests.formats.published import schema_text

__all__ = ["GENERATORS", "regenerate"]

#: Each returns the golden files that it is responsible for, and what belongs into them.
GENERATORS: tuple[Callable[[], dict[Path, str]], ...] = (
    help_texts,
    api_page,
    catalog_page,
    page_texts,
    schema_text,
)


def regenerate() -> list[Path]:
    """Write the golden files that have changed, and return them."""
    changed = []
    for generate in GENERATORS:
        for path, text in generate().items():
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8", newline="\n")
                changed.append(path)
    return changed


if __name__ == "__main__":
    written = regenerate()
    print("\n".join(f"rewritten: {path}" for path in written) or "all golden files are up to date")
