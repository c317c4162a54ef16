"""XML as plain elements with their lines. No document type, no entities of one's own, bounded depth and size."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NoReturn
from xml.parsers import expat

from nullbody.formats.document import Document

__all__ = ["XmlElement", "xml_tree"]

_DEEPEST = 256  # nested elements; chains of bodies are nested
_MOST_ELEMENTS = 100_000
_LONGEST = 60  # characters of a value in a message


@dataclass(frozen=True)
class XmlElement:
    """An element.

    Attributes:
        tag: its name.
        attributes: texts by name.
        children: elements in it.
        line: where it begins.
        given: the document, for messages.
    """

    tag: str
    attributes: Mapping[str, str]
    children: list[XmlElement]
    line: int
    given: Document = field(repr=False)

    @property
    def place(self) -> str:
        """As messages show it: <joint name='elbow'>."""
        name = self.attributes.get("name", "")[:_LONGEST]
        return f"<{self.tag} name={name!r}>" if name else f"<{self.tag}>"

    def refuse(self, what: str) -> NoReturn:
        """Raise a ModelFileError at this element."""
        raise self.given.error(what, self.place, self.line)

    def located(self, error: Exception) -> Exception:
        """An error of the builder with this place."""
        return self.given.located(error, self.place, self.line)

    def with_defaults(self, defaults: Mapping[str, str]) -> XmlElement:
        """The element with attributes where it has none of its own."""
        return replace(self, attributes={**defaults, **self.attributes})

    def all(self, *tags: str) -> Iterator[XmlElement]:
        """The children of these names, in order."""
        return (child for child in self.children if child.tag in tags)

    def text(self, name: str, default: str = "") -> str:
        """An attribute."""
        return self.attributes.get(name, default)

    def required(self, name: str) -> str:
        """An attribute that must be there."""
        if name not in self.attributes:
            self.refuse(f"the attribute {name!r} is missing")
        return self.attributes[name]

    def numbers(self, name: str, count: int | Sequence[int], default: Sequence[float] = ()) -> list[float]:
        """The numbers of an attribute.

        Args:
            name: of the attribute.
            count: how many there must be, or may be.
            default: where there is none.
        """
        if name not in self.attributes:
            return list(default)
        words = self.attributes[name].split()
        counts = [count] if isinstance(count, int) else list(count)
        if len(words) not in counts:
            wanted = " or ".join(map(str, counts)) if len(counts) < 4 else f"{counts[0]} to {counts[-1]}"
            self.refuse(f"{name} has {len(words)} numbers where {wanted} belong: {self.attributes[name][:_LONGEST]!r}")
        return [self._number(name, word) for word in words]

    def number(self, name: str, default: float = 0.0) -> float:
        """The single number of an attribute."""
        return self.numbers(name, 1, (default,))[0]

    def choice(self, name: str, known: Sequence[str], default: str) -> str:
        """An attribute that is one of several words."""
        word = self.attributes.get(name, default)
        if word not in known:
            self.refuse(f"{name} is {word[:_LONGEST]!r}; choose one of {', '.join(known)}")
        return word

    def _number(self, name: str, word: str) -> float:
        try:
            number = float(word) if word.isascii() and "_" not in word else math.nan
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            self.refuse(f"{name} must hold finite numbers, not {word[:_LONGEST]!r}")
        return number


def xml_tree(given: Document) -> XmlElement:
    """The root element of a document.

    Raises:
        ModelFileError: no XML, a document type or entities, nested too deeply, too many elements.
    """
    parser = expat.ParserCreate("utf-8")
    root: list[XmlElement] = []
    stack: list[XmlElement] = []
    count = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        line = parser.CurrentLineNumber
        if len(stack) >= _DEEPEST:
            raise given.error(f"elements are nested more than {_DEEPEST} deep", f"<{tag}>", line)
        if count > _MOST_ELEMENTS:
            raise given.error(f"it has more than {_MOST_ELEMENTS} elements", f"<{tag}>", line)
        element = XmlElement(tag, attributes, [], line, given)
        (stack[-1].children if stack else root).append(element)
        stack.append(element)

    def doctype(*_: object) -> NoReturn:
        raise given.error("a DOCTYPE is not allowed: entities can grow without limit", line=parser.CurrentLineNumber)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = doctype
    parser.EntityDeclHandler = doctype
    try:
        parser.Parse(given.text.encode(), True)
    except expat.ExpatError as error:
        raise given.error(f"this is no XML: {expat.ErrorString(error.code)}", line=error.lineno) from None
    return root[0]
