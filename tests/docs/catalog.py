"""docs/catalog.md from the catalog's entries, and its pictures: `python -m tests.docs.catalog` draws them again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nullbody import derive
from nullbody.catalog import ENTRIES, MODELS, STARTS, Entry, closed_form_of, starts
from nullbody.mechanism import Mechanism
from nullbody.report.album import draw_catalog
from tests.architecture.source import ROOT

__all__ = ["IMAGES", "catalog_page"]

IMAGES = ROOT / "docs" / "images"
_GROUPS = {"robot": "Robots", "linkage": "Linkages", "benchmark": "Published benchmarks"}
_HEAD = """# The catalog

Written by `make regenerate` from the catalog; a test compares. `make pictures` draws the pictures: bodies of one leg
have one colour, white bars are axes of revolute and universal joints, white circles pins and balls, black arrows the
inputs.

Each is a function of `nullbody.catalog` that takes parameter values and returns a `Mechanism`; `nullbody models NAME`
shows its parameters with their meaning, the docstring in [the public face](api.md#nullbodycatalog) its geometry.

```python
import nullbody

model = nullbody.build(nullbody.derive(nullbody.catalog.delta(la=0.3)))
state = nullbody.inverse_kinematics(model, {"x": 0.1, "y": 0.05, "z": -0.5})
print("arms at", *(f"{state[name]:.4f}" for name in ("alpha1", "alpha2", "alpha3")), "rad")
```

```text
arms at 0.2411 0.5430 0.7588 rad
```

"""


def catalog_page() -> dict[Path, str]:
    """The page and what belongs into it."""
    parts = [_HEAD, "| | | nq | nv |\n|---|---|---|---|\n", *(_line(entry) for entry in ENTRIES.values())]
    for group, title in _GROUPS.items():
        parts.append(f"\n## {title}\n")
        for entry in ENTRIES.values():
            if entry.group == group:
                parts += _section(entry, MODELS[entry.name]())
    return {ROOT / "docs" / "catalog.md": "".join(parts)}


def _line(entry: Entry) -> str:
    equations = derive(MODELS[entry.name]())
    sizes = f"{len(equations.coordinates)} | {len(equations.independent)}"
    return f"| [`{entry.name}`](#{entry.name}) | {entry.title} | {sizes} |\n"


def _section(entry: Entry, mechanism: Mechanism) -> Iterator[str]:
    yield f"\n### {entry.name}\n\n![{entry.title}](images/{entry.picture})\n\n**{entry.title}.** {entry.about}\n\n"
    units = {name: unit or "1" for name, unit in mechanism.units.items()}
    kinds = {unit: [name for name, own in units.items() if own == unit] for unit in dict.fromkeys(units.values())}
    rows = {
        "coordinates": "; ".join(f"{_names(names)} [{unit}]" for unit, names in kinds.items()),
        "inputs": ", ".join(f"`{actuator.name}` along `{actuator.coordinate}`" for actuator in mechanism.actuators),
        "degrees of freedom": f"{entry.degrees_of_freedom}: {entry.mobility}",
        "kinematics": "; ".join(_kinematics(entry, mechanism)),
        "parameters": ", ".join(f"`{name}` = {value:.6g}" for name, value in mechanism.values().items()),
        "motions": ", ".join(f"`{name}` ({start.source})" for name, start in starts(entry.name).items()),
        "source": entry.source,
    }
    if entry.name not in STARTS:
        del rows["motions"]
    yield "| | |\n|---|---|\n"
    yield from (f"| {title} | {text} |\n" for title, text in rows.items() if text)


def _names(names: list[str]) -> str:
    return " ".join(f"`{name}`" for name in names)


def _kinematics(entry: Entry, mechanism: Mechanism) -> Iterator[str]:
    """What is known in closed form; everything else is solved by Newton's method along the way from home."""
    form, values = closed_form_of(mechanism), mechanism.values()
    home = mechanism.home_values(values)
    if form is not None and form.assemblies(values, {name: home[name] for name in mechanism.actuated}) is not None:
        yield f"all assemblies for {_names(list(mechanism.actuated))} in closed form"
    if entry.task:
        exact = form is not None and form.inverse(values, {name: home[name] for name in entry.task}) is not None
        yield f"task {_names(list(entry.task))}, inverse {'in closed form' if exact else 'by Newton'}"


if __name__ == "__main__":
    print("\n".join(f"drawn: {path.relative_to(ROOT)}" for path in draw_catalog(IMAGES)))
