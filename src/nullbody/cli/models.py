"""nullbody models"""

from __future__ import annotations

from typing import Any

from nullbody.cli.options import Json
from nullbody.cli.output import print_json, print_table

__all__ = ["EXAMPLES", "models"]

EXAMPLES = ("nullbody models", "nullbody models --json")


def models(as_json: Json = False) -> None:
    """List the mechanisms of the catalog."""
    from nullbody.catalog import MODELS

    entries = {name: _entry(name) for name in MODELS}
    if as_json:
        print_json(entries)
        return
    for name, entry in entries.items():
        print(f"{name}: {entry['about']}")
        print(f"  nq = {len(entry['coordinates'])} coordinates: {' '.join(entry['coordinates'])}")
        print(f"  nv = {len(entry['independent'])} degrees of freedom: {' '.join(entry['independent'])}")
        print(f"  loops: {' '.join(entry['loops'])}")
        print(f"  inputs: {', '.join(f'{key} along {value}' for key, value in entry['inputs'].items())}\n")
        columns = ("parameter", "default", "formula", "unit", "meaning")
        rows = [(key, p["default"], p["formula"], p["unit"], p["meaning"]) for key, p in entry["parameters"].items()]
        print_table(columns, rows)


def _entry(name: str) -> dict[str, Any]:
    import inspect

    from nullbody.catalog import MODELS
    from nullbody.equations import derive

    mechanism = MODELS[name]()
    values = mechanism.values()
    return {
        "about": (inspect.getdoc(MODELS[name]) or "").partition("\n")[0],
        "coordinates": mechanism.coordinates,
        "units": mechanism.units,
        "independent": derive(mechanism).independent,
        "loops": [loop.name for loop in mechanism.loops],
        "inputs": {actuator.name: actuator.coordinate for actuator in mechanism.actuators},
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
