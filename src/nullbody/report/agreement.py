"""Section: the model against MuJoCo and Pinocchio on random admissible states."""

from __future__ import annotations

from nullbody.report.case import Case
from nullbody.report.section import Check, Part, Section, Table, Text, number
from nullbody.verify import EngineResult, compare

__all__ = ["agreement"]

_RELATIVE, _FORCE = 1e-12, 1e-11  # of accelerations and reactions; N
_QUANTITIES = {
    "forward_dynamics": "accelerations",
    "inverse_dynamics": "forces",
    "reactions": "joint reactions",
}


def agreement(case: Case) -> Section:
    """Accelerations, inverse-dynamics forces and reactions of every engine that is installed."""
    settings = case.settings
    engines: dict[str, EngineResult] = {}
    if case.engines:
        found = compare(case.model, engines=tuple(case.engines), states=settings.states, missing="skip")
        engines = {name: found[name] for name in case.engines}
    rows: list[tuple[str, ...]] = []
    checks: list[Check] = []
    numbers: dict[str, float | None] = {}
    for name in settings.engines:
        result = engines.get(name)
        quantities = result.quantities if result else {}
        forward, inverse = quantities.get("forward_dynamics"), quantities.get("inverse_dynamics")
        reactions = quantities.get("reactions")
        acceleration = forward.max_rel_error if forward else None
        force = inverse.max_abs_error if inverse else None
        numbers[f"forward_dynamics.max_rel_error.{name}"] = acceleration
        numbers[f"inverse_dynamics.max_abs_force_error.{name}"] = force
        numbers[f"reactions.max_rel_error.{name}"] = reactions.max_rel_error if reactions else None
        checks += [
            Check.at_most(f"Accelerations against {name}, relative", acceleration, _RELATIVE, "", "rounding"),
            Check.at_most(f"Inverse-dynamics forces against {name}", force, _FORCE, "N", "rounding of about 50 N"),
            Check.at_most(
                f"Joint reactions against {name}, relative",
                reactions.max_rel_error if reactions else None,
                _RELATIVE,
                "",
                "rounding",
            ),
        ]
        if result is None:
            rows.append((name, "missing", "-", "-", "-"))
        else:
            for key, value in result.quantities.items():
                sizes = (value.max_rel_error, value.median_rel_error, value.max_abs_error)
                rows.append((f"{name} {result.version}", _QUANTITIES[key], *(number(size) for size in sizes)))
    parts: list[Part] = [
        Text(
            f"{settings.states} random states on the constraint manifold (the home, symmetric and tilted poses) with "
            "random rates and forces. Each engine gets the mechanism's bodies, joints and loops, and builds its own "
            "model from them; no equation of this package enters."
        ),
        Table(
            ("engine", "quantity", ">max relative error", ">median relative", ">max absolute [SI]"),
            tuple(rows),
            "Errors of this package against the engine, relative to the largest entry of the engine's vector. The "
            "absolute errors look large where the quantities are: random forces give accelerations of hundreds of "
            "m/s².",
        ),
    ]
    for name in case.missing:
        parts.append(Text(f"<b>{name} was not run:</b> it is not installed here. {_ADVICE}"))
    return Section("engines", "Verification against engines", tuple(parts), tuple(checks), numbers)


_ADVICE = "Install it with <code>python -m pip install 'nullbody[verify]'</code> and run again."
