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

_ROOT = re.compile(r"\s*(?:<\?.*?\?>|<!--.*?-->|\s)*<(\w+)", re.S)


def read_model(source: Source, **options: Any) -> Mechanism:
    """A mechanism from a model file: YAML, MJCF (MuJoCo) or URDF.

    Args:
        source: a path that ends in .yaml, .yml, .xml, .mjcf or .urdf, or the text itself.
        options: of `read_mjcf` (ignore) or `read_urdf` (loops, actuators).

    Raises:
        ModelFileError: a file that cannot be read, or that says what nullbody does not model; the message gives
            file, line, place and what to try.
        MechanismError, UnknownName, ExpressionError: a mechanism that makes no sense, with the same.
    """
    given = document(source)
    kind = _kind(given)
    if kind == "YAML":
        if options:
            raise given.error(f"a YAML file takes no option {', '.join(options)}")
        return read_yaml_document(given)
    if kind == "URDF":
        return read_urdf_document(given, **options)
    return read_mjcf_document(given, **options)


def _kind(given: Document) -> str:
    """The format: of XML by the root element, of others by the suffix."""
    root = _ROOT.match(given.text)
    if root and root[1] in ("mujoco", "robot"):
        return "MJCF" if root[1] == "mujoco" else "URDF"
    if given.suffix in SUFFIXES or given.text.lstrip().startswith("<"):
        return SUFFIXES.get(given.suffix, "MJCF")
    if given.suffix:
        raise given.error(f"a model file ends in one of {', '.join(SUFFIXES)}, not in {given.suffix!r}")
    return "YAML"
