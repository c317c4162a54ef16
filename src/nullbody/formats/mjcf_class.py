"""MJCF's default classes: what an element has without saying so."""

from __future__ import annotations

from collections.abc import Mapping

from nullbody.formats.xml_tree import XmlElement

__all__ = ["Classes"]

_ACTUATORS = ("motor", "general", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion")
_ALIASES = {**dict.fromkeys(_ACTUATORS, "general"), "spatial": "tendon", "fixed": "tendon"}  # share their defaults
_LAW = ("dyntype", "gaintype", "biastype", "gainprm")  # a <motor> has its own: the force is gear times the control
_Attributes = dict[str, dict[str, str]]  # tag -> attribute -> text


class Classes:
    """The classes of a document, each with what it takes over from the one around it.

    Args:
        root: <mujoco>; its <default> elements are read.

    Raises:
        ModelFileError: a class twice, or without a name.
    """

    def __init__(self, root: XmlElement) -> None:
        self._main: _Attributes = {}
        self._classes: dict[str, _Attributes] = {"main": self._main}
        for top in root.all("default"):
            name = top.text("class", "main")
            self._read(top, self._main)
            self._classes[name] = self._main
            self._nested(top, self._main)

    def _nested(self, outer: XmlElement, inherited: _Attributes) -> None:
        for element in outer.all("default"):
            name = element.required("class")
            if name in self._classes:
                element.refuse(f"the class {name!r} is there twice")
            own = {tag: dict(attributes) for tag, attributes in inherited.items()}
            self._read(element, own)
            self._classes[name] = own
            self._nested(element, own)

    def _read(self, element: XmlElement, into: _Attributes) -> None:
        for child in element.children:
            if child.tag != "default":
                tag = _ALIASES.get(child.tag, child.tag)
                known = into.setdefault(tag, {})
                if tag == "general" and child.tag != "general":
                    _forget_law(known, child.tag)
                known.update(child.attributes)

    def resolved(self, element: XmlElement, around: str | None) -> XmlElement:
        """An element with the attributes of its own class, or of that of the body around it."""
        name = element.text("class") or around or "main"
        if name not in self._classes:
            element.refuse(f"there is no class {name!r}; known: {', '.join(self._classes)}")
        defaults: Mapping[str, str] = self._classes[name].get(_ALIASES.get(element.tag, element.tag), {})
        if element.tag == "motor":
            defaults = {key: value for key, value in defaults.items() if key not in _LAW}
            for key in element.attributes:
                if key in _LAW:
                    element.refuse(f"a <motor> has no {key}: write <general>")
        return element.with_defaults(defaults)

    def equality(self, element: XmlElement) -> XmlElement:
        """An equality constraint with the attributes of its class: there are no defaults for joints in this sense."""
        name = element.text("class") or "main"
        if name not in self._classes:
            element.refuse(f"there is no class {name!r}; known: {', '.join(self._classes)}")
        return element.with_defaults(self._classes[name].get("equality", {}))


def _forget_law(known: dict[str, str], tag: str) -> None:
    """The defaults of actuators after one that brings a law of its own: MuJoCo resets the law, and keeps the rest."""
    for key in _LAW:
        known.pop(key, None)
    if tag != "motor":
        known["biastype"] = tag  # which is refused where it is used
