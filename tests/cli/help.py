"""The help texts as users see them, at a fixed width."""

from __future__ import annotations

import os
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from unittest.mock import patch

from nullbody.cli import main
from nullbody.cli.app import COMMANDS, EXPORTS

__all__ = ["NAMES", "help_text", "help_texts"]

NAMES = (
    "nullbody",
    *(command.__name__ for command in COMMANDS),
    "export",
    *(f"export {kind}" for kind in EXPORTS),
)
_FOLDER = Path(__file__).parent / "golden"


def help_text(name: str) -> str:
    """What `nullbody <name> --help` prints on a terminal of 100 columns; `nullbody --help` for the name nullbody."""
    printed = StringIO()
    with patch.dict(os.environ, COLUMNS="100"), redirect_stdout(printed):
        assert main(["--help"] if name == "nullbody" else [*name.split(), "--help"]) == 0
    return printed.getvalue()


def help_texts() -> dict[Path, str]:
    """The golden file of every help text, and what belongs into it."""
    return {_FOLDER / f"{name.replace(' ', '_')}.txt": help_text(name) for name in NAMES}
