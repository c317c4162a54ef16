"""What is known of each mechanism of the catalog beside its equations: title, mobility and why, source, picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["Entry"]


@dataclass(frozen=True)
class Entry:
    """A mechanism of the catalog, for people.

    Attributes:
        name: in the catalog.
        title: a few words.
        group: "robot", "linkage" or "benchmark".
        about: one sentence.
        degrees_of_freedom: of its velocities, nv.
        mobility: why there are as many.
        task: the coordinates that `inverse_kinematics` takes, of the end effector; none where it has no task.
        source: author, where, year.
        arguments: of the catalog's function, for the picture.
        pose: coordinates at the picture that differ from home [m, rad].
        view: azimuth and elevation of the picture [degrees].
    """

    name: str
    title: str
    group: str
    about: str
    degrees_of_freedom: int
    mobility: str
    source: str
    task: tuple[str, ...] = ()
    arguments: Mapping[str, int] = field(default_factory=dict)
    pose: Mapping[str, float] = field(default_factory=dict)
    view: tuple[float, float] = (25.0, 22.0)

    @property
    def picture(self) -> str:
        """The file in docs/images."""
        return f"{self.name}.png"
