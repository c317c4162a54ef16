"""The pictures of docs/catalog.md, one for each mechanism of the catalog."""

from __future__ import annotations

from pathlib import Path

from nullbody.catalog import ENTRIES, MODELS, Entry
from nullbody.equations import derive
from nullbody.kinematics import assemble
from nullbody.model import Model, State, build
from nullbody.report.draw import draw
from nullbody.report.output import usable_folder
from nullbody.report.picture import robot_picture

__all__ = ["draw_catalog", "picture_pose"]


def draw_catalog(folder: str | Path, *names: str) -> list[Path]:
    """Draw mechanisms of the catalog, all of them by default, each into a file with its name.

    Raises:
        OutputError: the folder cannot be written.
    """
    target = usable_folder(folder)
    return [_drawn(ENTRIES[name], target) for name in names or ENTRIES]


def _drawn(entry: Entry, folder: Path) -> Path:
    if entry.name == "three_prs":
        return robot_picture(folder / entry.picture)
    model = build(derive(MODELS[entry.name](**entry.arguments)))
    azimuth, elevation = entry.view
    return draw(model, picture_pose(model, entry), folder / entry.picture, azimuth=azimuth, elevation=elevation)


def picture_pose(model: Model, entry: Entry) -> State:
    """The entry's coordinates: held where they are independent, else the start from which the loops are closed."""
    held = {name: value for name, value in entry.pose.items() if name in (*model.independent, *entry.task)}
    return assemble(model, held, guess=entry.pose)
