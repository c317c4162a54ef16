"""summary.json: the stable keys of the report, nested by the dots, without NaN or infinity."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from nullbody.report.section import Section

__all__ = ["summary_text"]


def summary_text(sections: Sequence[Section], more: Mapping[str, Any]) -> str:
    """All numbers of the sections and some more as JSON text.

    Args:
        sections: their `numbers` have dotted keys.
        more: further dotted keys, such as versions.
    """
    nested: dict[str, Any] = {}
    for numbers in (*(section.numbers for section in sections), more):
        for key, value in numbers.items():
            place = nested
            *path, last = key.split(".")
            for name in path:
                place = place.setdefault(name, {})
            place[last] = _plain(value)
    return json.dumps(nested, indent=2, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    """A value that JSON has: NumPy numbers as Python's, what is not finite as null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
