"""YAML as plain values with their lines: the JSON subset of YAML 1.2, and nothing that could grow or act.

Read from the parser's events, so that depth and number of nodes are checked before anything is built. No anchors,
no aliases, no tags, no key twice. Scalars follow YAML 1.2: `on`, `yes` and 1e-3 are what they look like.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.formats.document import Document

__all__ = ["FLOAT_TEXT", "Node", "yaml_tree"]

#: What YAML 1.2 takes for a number.
FLOAT_TEXT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$")

_DEEPEST = 24  # nested lists and mappings
_MOST_NODES = 100_000
_LONGEST = 60  # characters of a value in a message
_INT = re.compile(r"[-+]?[0-9]+")
_PLAIN = {"": None, "~": None, "null": None, "true": True, "false": False}


@dataclass(frozen=True)
class Node:
    """A value and the line where it begins.

    Attributes:
        value: None, bool, int, float, str, a list of nodes, or a dict of nodes.
        line: from 1.
    """

    value: Any
    line: int

    def plain(self) -> Any:
        """The value without lines."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def at(self, path: Sequence[object]) -> tuple[Node, tuple[str, ...]]:
        """The node at a path of keys and indices, as far as it goes, and the path that was found."""
        found: list[str] = []
        node = self
        for key in path:
            inner = node.value
            listed = isinstance(inner, list) and isinstance(key, int) and key < len(inner)
            if listed or (isinstance(inner, dict) and key in inner):
                node = inner[key]
                found.append(str(key))
        return node, tuple(found)


def yaml_tree(given: Document) -> Node:
    """The single document of a text.

    Raises:
        ModelFileError: no YAML, or YAML that model files may not have.
    """
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        events = yaml.parse(given.text, Loader=loader)
        return _Composer(given, events).document()
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = mark.line + 1 if mark is not None else _line_of(given.text, getattr(error, "position", None))
        what = getattr(error, "problem", None) or getattr(error, "reason", None) or "it is no YAML"
        raise given.error(f"this is no YAML: {what}", line=line) from None


class _Composer:
    """Puts events together."""

    def __init__(self, given: Document, events: Iterator[Any]) -> None:
        self.given = given
        self.events = events
        self.nodes = 0

    def document(self) -> Node:
        first = ""
        while first != "DocumentStartEvent":
            first = type(event := next(self.events)).__name__
            if first == "StreamEndEvent":
                raise self.given.error("it is empty; a model file has at least name and bodies")
        node = self.node(next(self.events), ())
        next(self.events)  # the end of the document
        after = next(self.events)
        if type(after).__name__ != "StreamEndEvent":
            raise self.given.error("a model file is one YAML document, and here another one begins", line=_line(after))
        del event
        return node

    def node(self, event: Any, path: tuple[str, ...]) -> Node:
        kind, line, place = type(event).__name__, _line(event), ".".join(path)
        self.nodes += 1
        if self.nodes > _MOST_NODES:
            raise self.given.error(f"it has more than {_MOST_NODES} values", place, line)
        if len(path) > _DEEPEST:
            raise self.given.error(f"it is nested more than {_DEEPEST} deep", place, line)
        if kind == "AliasEvent" or getattr(event, "anchor", None):
            raise self.given.error("anchors and aliases (&, *) are not allowed: write the value twice", place, line)
        if getattr(event, "tag", None):
            raise self.given.error(f"tags such as {event.tag[:_LONGEST]} are not allowed", place, line)
        if kind == "SequenceStartEvent":
            return Node(self._items(path), line)
        if kind == "MappingStartEvent":
            return Node(self._entries(path), line)
        return Node(self._scalar(event, place, line), line)

    def _items(self, path: tuple[str, ...]) -> list[Node]:
        items: list[Node] = []
        while type(event := next(self.events)).__name__ != "SequenceEndEvent":
            items.append(self.node(event, (*path, str(len(items)))))
        return items

    def _entries(self, path: tuple[str, ...]) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        while type(event := next(self.events)).__name__ != "MappingEndEvent":
            line = _line(event)
            if type(event).__name__ != "ScalarEvent":
                raise self.given.error("a key is a name, not a list or a mapping", ".".join(path), line)
            name: str = event.value
            if name in entries:
                raise self.given.error(
                    f"the key {name[:_LONGEST]!r} is there twice, first in line {entries[name].line}; rename one",
                    ".".join(path),
                    line,
                )
            entries[name] = self.node(next(self.events), (*path, name[:_LONGEST]))
        return entries

    def _scalar(self, event: Any, place: str, line: int) -> Any:
        text: str = event.value
        if not event.implicit[0]:  # quoted
            return text
        if text in _PLAIN:
            return _PLAIN[text]
        if _INT.fullmatch(text):
            return int(text) if len(text) <= 300 else self._refuse_number(place, line)
        if FLOAT_TEXT.fullmatch(text):
            number = float(text)
            vanishes = not any(digit in "123456789" for digit in text.lower().partition("e")[0])
            if number in (float("inf"), float("-inf")) or (number == 0 and not vanishes):
                self._refuse_number(place, line)
            return number
        return text

    def _refuse_number(self, place: str, line: int) -> Any:
        raise self.given.error("a number must lie in the range of doubles, about 1e308", place, line)


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _line_of(text: str, position: int | None) -> int:
    return 0 if position is None else text.count("\n", 0, position) + 1
