"""The published JSON schema of model files."""

from __future__ import annotations

import json
from pathlib import Path

from nullbody.formats.schema import json_schema
from tests.architecture.source import SRC

__all__ = ["schema_text"]


def schema_text() -> dict[Path, str]:
    """The file and what belongs into it."""
    return {SRC / "formats" / "schema.json": json.dumps(json_schema(), indent=1) + "\n"}
