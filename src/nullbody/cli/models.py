"""nullbody models"""

from __future__ import annotations

from typing import Annotated, Any

import typer

from nullbody.cli.options import Json
from nullbody.cli.output import print_json, print_table

__all__ = ["EXAMPLES", "models"]

EXAMPLES = ("nullbody models", "nullbody models delta", "nullbody models --json")

Name = Annotated[str | None, typer.Argument(metavar="[MECHANISM]", help="Show all about this one.")]


def models(mechanism: Name = None, as_json: Json = False) -> None:
    """List the mechanisms of the catalog, or show one: coordinates, mobility, inputs, parameters, source."""
    from nullbody.catalog import ENTRIES, describe

    entries = {name: _entry(name) for name in (ENTRIES if mechanism is None else [describe(mechanism).name])}
    if as_json:
        print_json(entries)
    elif mechanism is None:
        rows = [(name, e["title"], len(e["coordinates"]), len(e["independent"])) for name, e in entries.items()]
        print_table(("mechanism", "", "nq", "nv"), rows)
        print("`nullbody models MECHANISM` shows one of them; docs/catalog.md has pictures.")
    else:
        for name, entry in entries.items():
            _print(name, entry)


def _print(name: str, entry: dict[str, Any]) -> None:
    print(f"{name}: {entry['title']}. {entry['about']}")
    print(f"  nq = {len(entry['coordinates'])} coordinates: {' '.join(entry['coordinates'])}")
    print(f"  nv = {len(entry['independent'])} degrees of freedom: {' '.join(entry['independent'])}")
    print(f"  mobility: {entry['mobility']}")
    print(f"  loops: {' '.join(entry['loops']) or 'none'}")
    print(f"  inputs: {', '.join(f'{key} along {value}' for key, value in entry['inputs'].items())}")
    print(f"  task: {' '.join(entry['task']) or 'none'}")
    print(f"  source: {entry['source']}")
    print(f"  picture: docs/images/{entry['picture']}\n")
    columns = ("parameter", "default", "formula", "unit", "meaning")
    rows = [(key, p["default"], p["formula"], p["unit"], p["meaning"]) for key, p in entry["parameters"].items()]
    print_table(columns, rows)


def _entry(name: str) -> dict[str, Any]:
    from nullbody.catalog import MODELS, describe
    from nullbody.equations import derive

    mechanism, known = MODELS[name](), describe(name)
    values = mechanism.values()
    return {
        "title": known.title,
        "about": known.about,
        "coordinates": mechanism.coordinates,
        "units": mechanism.units,
        "independent": derive(mechanism).independent,
        "mobility": known.mobility,
        "loops": [loop.name for loop in mechanism.loops],
        "inputs": {actuator.name: actuator.coordinate for actuator in mechanism.actuators},
        "task": known.task,
        "source": known.source,
        "picture": known.picture,
        "parameters": {
            parameter.name: {
                "default": values[parameter.name],
                "formula": parameter.default if isinstance(parameter.default, str) else "",
                "unit": parameter.unit,
                "meaning": parameter.meaning,
                "sign": parameter.sign,
            }
            for parameter in mechanism.parameters
        },
    }
