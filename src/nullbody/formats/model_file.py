"""Model files of any format, told apart by their names or by how they begin."""

from __future__ import annotations

import re
from typing import Any

from nullbody.formats.document import Document, Source, document
from nullbody.formats.mjcf_reader import read_mjcf_document
from nullbody.formats.urdf_reader import read_urdf_document
from nullbody.formats.yaml_reader import read_yaml_document
from nullbody.mechanism import Mechanism

__all__ = ["SUFFIXES", "read_model"]

#: What the names of model files end with, and the format.
SUFFIXES = {".yaml": "YAML", ".yml": "YAML", ".xml": "MJCF", ".mjcf": "MJCF", ".urdf": "URDF"}

_BLANK = re.compile(r"\s*")
_TAG = re.compile(r"<(\w+)")
_SKIPPED = (("<?", "?>"), ("<!--", "-->"))  # what may stand before the root element
_OPTIONS = {"YAML": (), "MJCF": ("ignore",), "URDF": ("loops", "actuators", "gravity")}


def read_model(source: Source, **options: Any) -> Mechanism:
    """A mechanism from a model file: YAML, MJCF (MuJoCo) or URDF.

    Args:
        source: a path that ends in .yaml, .yml, .xml, .mjcf or .urdf, or the text itself.
        options: of `read_mjcf` (ignore) or `read_urdf` (loops, actuators, gravity).

    Raises:
        ModelFileError: a file that cannot be read, or that says what nullbody does not model, or an option that its
            format does not have; the message gives file, line, place and what to try.
        MechanismError, UnknownName, ExpressionError: a mechanism that makes no sense, with the same.
    """
    given = document(source)
    kind = _kind(given)
    for name in options:
        if name not in _OPTIONS[kind]:
            known = ", ".join(_OPTIONS[kind]) or "none"
            article = "an" if kind == "MJCF" else "a"
            raise given.error(f"{article} {kind} file takes no option {name!r}; it takes: {known}")
    if kind == "YAML":
        return read_yaml_document(given)
    if kind == "URDF":
        return read_urdf_document(given, **options)
    return read_mjcf_document(given, **options)


def _kind(given: Document) -> str:
    """The format: of XML by the root element, of others by the suffix."""
    root = _root_tag(given.text)
    if root in ("mujoco", "robot"):
        return "MJCF" if root == "mujoco" else "URDF"
    if given.suffix in SUFFIXES or given.text.lstrip().startswith("<"):
        return SUFFIXES.get(given.suffix, "MJCF")
    if given.suffix:
        raise given.error(f"a model file ends in one of {', '.join(SUFFIXES)}, not in {given.suffix!r}")
    return "YAML"


def _root_tag(text: str) -> str:
    """The name of the root element behind comments and processing instructions; empty where there is none."""
    at = _BLANK.match(text).end()  # type: ignore[union-attr]
    while True:
        skipped = next(((begin, end) for begin, end in _SKIPPED if text.startswith(begin, at)), None)
        if skipped is None:
            found = _TAG.match(text, at)
            return found[1] if found else ""
        begin, end = skipped
        closed = text.find(end, at + len(begin))
        if closed < 0:
            return ""
        at = _BLANK.match(text, closed + len(end)).end()  # type: ignore[union-attr]
