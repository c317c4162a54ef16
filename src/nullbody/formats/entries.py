"""Joints given as mappings, with the same keys as in a model file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from nullbody.errors import ModelFileError
from nullbody.mechanism import MechanismBuilder

__all__ = ["add_joint_entries"]


def add_joint_entries(
    builder: MechanismBuilder,
    given: Sequence[Mapping[str, Any]] | Mapping[str, Mapping[str, Any]],
    bodies: Mapping[str, str],
) -> None:
    """Tell a builder joints that close loops.

    Args:
        builder: what is told.
        given: mappings with a key "name", or name -> mapping; each as under `joints` in a model file.
        bodies: other names of bodies that the mappings may use -> names in the builder.

    Raises:
        ModelFileError: an entry that the schema does not have.
        MechanismError, UnknownName, ExpressionError: by the builder.
    """
    from nullbody.formats.yaml_reader import checked_joints, fill

    _check_collection(given)
    entries: dict[str, Any] = {}
    pairs = given.items() if isinstance(given, Mapping) else ((None, entry) for entry in given)
    for key, entry in pairs:
        if not isinstance(entry, Mapping):
            raise ModelFileError(f"a loop is a mapping with name, type, parent, child, not {entry!r}", file="loops")
        name = key if key is not None else entry.get("name")
        if not isinstance(name, str):
            raise ModelFileError(f"a loop needs a name: {dict(entry)!r}", file="loops")
        if name in entries:
            raise ModelFileError(f"two loops have the name {name!r}", file="loops")
        ends = [end for end in ("parent", "child") if isinstance(entry.get(end), str)]
        renamed = {end: bodies.get(entry[end], entry[end]) for end in ends}
        entries[name] = {k: v for k, v in entry.items() if k != "name"} | renamed
    checked = checked_joints(entries)
    for name, entry in checked["joints"].items():
        closes = {} if entry["type"] in ("distance", "point_on_line", "point_on_plane") else {"loop": True}
        fill(builder, {"joints": {name: {**entry, **closes}}}, lambda *_: lambda error: error)


def _check_collection(given: Any) -> None:
    if isinstance(given, str) or not isinstance(given, Mapping | Sequence):
        raise ModelFileError(f"loops are a list of mappings, or name -> mapping, not {given!r}", file="loops")
