"""The variables of a unit: names, value references, units, starts, and what each depends on.

Value references are places in groups that follow each other, the same for the C code and for modelDescription.xml:

    time | q | v | q' | q'' | u | p | power of inputs | reactions | power, T, U, gap | tolerance, drift
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from nullbody.equations import Equations
from nullbody.export.fmu.units import times
from nullbody.model import Model, State

__all__ = ["DRIFT", "TOLERANCE", "Group", "Unit", "Variable"]

#: Relative tolerance of the local error of the unit's own integrator.
TOLERANCE = 1e-8

#: |Phi| beyond which the loops are closed by an event in model exchange [m].
DRIFT = 1e-6

Causality = Literal["independent", "input", "output", "local", "parameter", "calculatedParameter"]

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_QUOTABLE = re.compile(r"[A-Za-z0-9_!#$%&()*+,\-./:;<>=@\[\]^{}|~ ]+")


@dataclass(frozen=True)
class Variable:
    """One scalar of the unit.

    Attributes:
        name, unit, meaning: for people.
        reference: its value reference.
        causality: of FMI.
        initial: "exact", "approx", "calculated", or "" for inputs and time.
        start: its value before initialization; None where it is calculated.
        derivative_of: value reference of the state whose derivative it is.
        depends: value references of the states and inputs that it depends on; None for all of them.
        least: least value.
    """

    name: str
    reference: int
    unit: str
    meaning: str
    causality: Causality
    initial: str = ""
    start: float | None = None
    derivative_of: int | None = None
    depends: tuple[int, ...] | None = None
    least: float | None = None

    @property
    def variability(self) -> str:
        """As FMI calls it: parameters are fixed, all else is continuous."""
        return "fixed" if self.causality in ("parameter", "calculatedParameter") else "continuous"


@dataclass(frozen=True)
class Group:
    """Value references that follow each other: the name that C has for the first one, and how many."""

    name: str
    first: int
    count: int

    def __getitem__(self, k: int) -> int:
        return self.first + k


@dataclass(frozen=True, eq=False)
class Unit:
    """What is exported: the equations, parameter values, a start.

    Attributes:
        equations: what moves.
        model: the same with parameter values.
        state: where it begins.
        reactions: whether the reactions of the closures are outputs.
        charts: the equations in all independent coordinates that co-simulation may use, `equations` first.
    """

    equations: Equations
    model: Model
    state: State
    reactions: bool
    charts: tuple[Equations, ...]

    @property
    def identifier(self) -> str:
        """The mechanism's name as a C identifier."""
        name = re.sub(r"\W", "_", self.model.mechanism.name, flags=re.ASCII)
        return name if re.match(r"[A-Za-z]", name) else f"model_{name}"

    @cached_property
    def follows(self) -> tuple[bool, ...]:
        """For every parameter whether its value follows others by a formula."""
        given = self.model.given
        return tuple(isinstance(p.default, str) and p.name not in given for p in self.model.mechanism.parameters)

    @cached_property
    def groups(self) -> dict[str, Group]:
        """The groups of value references by the name that C has for them."""
        nq, nv, nu = len(self.model.coordinates), len(self.model.independent), len(self.model.inputs)
        counts = {"TIME": 1, "Q": nq, "V": nv, "Q_DOT": nq, "Q_DDOT": nq, "U": nu, "P": len(self.model.values)}
        counts |= {"INPUT_POWER": nu, "REACTION": len(self.model.labels) if self.reactions else 0}
        counts |= dict.fromkeys(("POWER", "KINETIC", "POTENTIAL", "GAP", "TOLERANCE", "DRIFT"), 1)
        groups, first = {}, 0
        for name, count in counts.items():
            groups[name] = Group(name, first, count)
            first += count
        return groups

    @cached_property
    def structured(self) -> bool:
        """Whether all names fit FMI's grammar for structured names; otherwise they stand as they are."""
        return all(_QUOTABLE.fullmatch(label) for label in self.model.labels)

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """All of them: the time, states, what follows from them, inputs and what follows, parameters."""
        time = Variable("t", self.groups["TIME"][0], "s", "time", "independent")
        followed = (*self._rates(), *self._measures(), *self._driven(), *self._reactions())
        return (time, *self._states(), *followed, *self._constants())

    @property
    def states(self) -> tuple[Variable, ...]:
        """q and v."""
        known = {variable.reference: variable for variable in self.variables}
        groups = self.groups
        return tuple(known[group[k]] for group in (groups["Q"], groups["V"]) for k in range(group.count))

    @property
    def derivatives(self) -> tuple[Variable, ...]:
        """Of all states, in their order."""
        found = {v.derivative_of: v for v in self.variables if v.derivative_of is not None}
        return tuple(found[state.reference] for state in self.states)

    def _states(self) -> Iterator[Variable]:
        model, units = self.model, self.model.mechanism.units
        for k, name in enumerate(model.coordinates):
            at, initial = self.groups["Q"][k], "exact" if name in model.independent else "approx"
            start = float(self.state.q[k])
            yield Variable(name, at, units[name], f"coordinate {name}", "output", initial, start, depends=(at,))
        for k, name in enumerate(model.independent):
            at, unit = self.groups["V"][k], times(units[name], "/s")
            meaning, start = f"rate of the independent coordinate {name}", float(self.state.v[k])
            yield Variable(f"{name}_dot", at, unit, meaning, "output", "exact", start, depends=(at,))

    @property
    def _moving(self) -> tuple[int, ...]:
        """The value references of all states."""
        return tuple(self.groups[name][k] for name in ("Q", "V") for k in range(self.groups[name].count))

    def _rates(self) -> Iterator[Variable]:
        model, groups, units = self.model, self.groups, self.model.mechanism.units
        free = {name: groups["V"][k] for k, name in enumerate(model.independent)}
        for k, name in enumerate(model.coordinates):
            yield Variable(
                f"der({name})" if name in free else f"{name}_dot",
                groups["Q_DOT"][k],
                times(units[name], "/s"),
                f"rate of {name}",
                "local" if name in free else "output",
                "calculated",
                derivative_of=groups["Q"][k],
                depends=(free[name],) if name in free else self._moving,
            )
        for k, name in enumerate(model.coordinates):
            yield Variable(
                f"{name}_ddot",
                groups["Q_DDOT"][k],
                times(units[name], "/s^2"),
                f"acceleration of {name}",
                "output",
                "calculated",
                derivative_of=free.get(name),
            )

    def _measures(self) -> Iterator[Variable]:
        """Scalars that depend on the states alone."""
        positions = self._moving[: len(self.model.coordinates)]
        for name, group, unit, meaning, on in (
            ("energy.kinetic", "KINETIC", "J", "kinetic energy", self._moving),
            ("energy.potential", "POTENTIAL", "J", "potential energy", positions),
            ("loops.gap", "GAP", "m", "largest |Phi|: how far the loops are open", positions),
        ):
            yield Variable(name, self.groups[group][0], unit, meaning, "output", "calculated", depends=on)

    def _driven(self) -> Iterator[Variable]:
        """Inputs, and what depends on them."""
        mechanism, groups = self.model.mechanism, self.groups
        for k, actuator in enumerate(mechanism.actuators):
            unit = _conjugate(mechanism.units[actuator.coordinate])
            limited = "" if actuator.limits is None else "; held within its limits"
            meaning = f"input {actuator.name}, along {actuator.coordinate}{limited}"
            yield Variable(actuator.name, groups["U"][k], unit, meaning, "input", "", 0.0)
        meaning = "power of inputs, drives and loads without a potential"
        yield Variable("power.total", groups["POWER"][0], "W", meaning, "output", "calculated")
        for k, actuator in enumerate(mechanism.actuators):
            at = groups["INPUT_POWER"][k]
            yield Variable(f"power.{actuator.name}", at, "W", f"power of {actuator.name}", "output", "calculated")

    def _reactions(self) -> Iterator[Variable]:
        mechanism, group = self.model.mechanism, self.groups["REACTION"]
        rows = dict((*mechanism.holonomic_rows, *mechanism.nonholonomic_rows))
        for k, label in enumerate(self.model.labels[: group.count]):
            meaning = f"lambda of {label}: acts with -lambda on the parent, with +lambda on the child"
            unit = _conjugate(rows[label].removesuffix("/s"))
            yield Variable(f"reaction.{self._quoted(label)}", group[k], unit, meaning, "output", "calculated")

    def _constants(self) -> Iterator[Variable]:
        model = self.model
        for k, (parameter, value) in enumerate(zip(model.mechanism.parameters, model.values, strict=True)):
            at, meaning = self.groups["P"][k], parameter.meaning or f"parameter {parameter.name}"
            if self.follows[k]:
                meaning = f"{meaning}: {parameter.default}"
                yield Variable(parameter.name, at, parameter.unit, meaning, "calculatedParameter", "calculated")
            else:
                least = None if parameter.sign == "any" else 0.0
                start = float(value)
                yield Variable(parameter.name, at, parameter.unit, meaning, "parameter", "exact", start, least=least)
        meaning = "relative tolerance of the local error in co-simulation; absolute: 0.01 of it"
        at = self.groups["TOLERANCE"][0]
        yield Variable("solver.tolerance", at, "", meaning, "parameter", "exact", TOLERANCE, least=0.0)
        meaning = "opening of the loops beyond which an event closes them in model exchange"
        yield Variable("solver.drift", self.groups["DRIFT"][0], "m", meaning, "parameter", "exact", DRIFT, least=0.0)

    def _quoted(self, label: str) -> str:
        """A label such as "leg1 x" as the end of a structured name: leg1.x, or in quotes."""
        if not self.structured:
            return re.sub(r"[\r\n\t]", " ", label)
        loop, _, row = label.rpartition(" ")
        plain = all(_IDENTIFIER.fullmatch(part) for part in (loop, row))
        return f"{loop}.{row}" if plain else f"'{label}'"


def _conjugate(unit: str) -> str:
    """The unit of the force that belongs to a coordinate or a residual."""
    return {"m": "N", "rad": "N m"}.get(unit, "J")
