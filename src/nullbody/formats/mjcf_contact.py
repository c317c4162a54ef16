"""Which geoms of an MJCF document could touch: contact is not modelled, so that this must not pass in silence."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations

from nullbody.formats.xml_tree import XmlElement

__all__ = ["Surface", "refuse_contacts"]


@dataclass(frozen=True)
class Surface:
    """A geom that can touch others.

    Attributes:
        element: the geom with its defaults.
        body: that it is fixed on, by its name in the document, which may be empty.
        welded: the nearest body up the tree that can move, or the ground: geoms of one do not touch each other.
        above: `welded` of what carries that body.
    """

    element: XmlElement
    body: str
    welded: str
    above: str

    @property
    def masks(self) -> tuple[int, int]:
        """contype and conaffinity."""
        return int(self.element.number("contype", 1)), int(self.element.number("conaffinity", 1))


def refuse_contacts(root: XmlElement, surfaces: list[Surface], bodies: Collection[str], ground: str) -> None:
    """Raise where MuJoCo would look for contact: <pair>, or two geoms whose masks meet.

    Geoms of one body, and of a body and the one that carries it, are left out, as MuJoCo does.
    """
    switched = [f for option in root.all("option") for f in option.all("flag") if f.text("contact") == "disable"]
    if switched:
        return
    apart = set()
    for contact in root.all("contact"):
        for pair in contact.all("pair"):
            pair.refuse(f"contact is not modelled here: take it out{_ADVICE}")
        apart |= {_excluded(exclude, bodies) for exclude in contact.all("exclude")}
    family = not any(f.text("filterparent") == "disable" for option in root.all("option") for f in option.all("flag"))
    touching = [surface for surface in surfaces if any(surface.masks)]
    for a, b in combinations(touching, 2):
        if a.welded == b.welded or frozenset((a.body, b.body)) in apart:
            continue
        related = (a.above == b.welded != ground) or (b.above == a.welded != ground)
        (type_a, affinity_a), (type_b, affinity_b) = a.masks, b.masks
        if not (related and family) and (type_a & affinity_b or type_b & affinity_a):
            a.element.refuse(
                f"it can touch {b.element.place} of line {b.element.line}, and contact is not modelled here{_ADVICE}"
            )


def _excluded(exclude: XmlElement, bodies: Collection[str]) -> frozenset[str]:
    """The two bodies of an <exclude>."""
    names = [exclude.required(attribute) for attribute in ("body1", "body2")]
    for name in names:
        if name not in bodies:
            exclude.refuse(f"there is no body {name!r}; a body that is excluded needs a name")
    return frozenset(names)


_ADVICE = (
    ": set contype='0' conaffinity='0', or <option><flag contact='disable'/></option>, or give ignore=('contact',)"
)
