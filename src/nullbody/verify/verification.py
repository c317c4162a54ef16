"""What a comparison with independent engines found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from nullbody.errors import UnknownName, VerificationError
from nullbody.model import State
from nullbody.typing import FloatArray

__all__ = ["Discrepancy", "EngineResult", "Verification"]

_QUANTITIES = {
    "forward_dynamics": "q''",
    "inverse_dynamics": "inverse-dynamics forces",
    "reactions": "reactions",
}


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """One quantity of the model against one engine, over all states.

    Attributes:
        max_rel_error, median_rel_error: of the states' errors, each relative to the largest entry of the engine's
            vector in that state (for inputs: of inputs and reactions together), or to a thousandth of a typical
            acceleration or force where that is larger.
        max_abs_error: in the quantity's own units.
        state: number of the worst state.
        worst: that state.
        ours, theirs: the vectors there.
    """

    max_rel_error: float
    median_rel_error: float
    max_abs_error: float
    state: int
    worst: State
    ours: FloatArray
    theirs: FloatArray


@dataclass(frozen=True, eq=False)
class EngineResult:
    """What one engine says about a model.

    Attributes:
        name, version: of the engine.
        quantities: "forward_dynamics", q'' for random inputs; "inverse_dynamics", inputs for random admissible
            accelerations where the mechanism has one input for each degree of freedom, N^T (M q'' + h) otherwise;
            "reactions", lambda, where there are constraints (A^T lambda where some of them are redundant).
        skipped: why it did not run, or nothing.
    """

    name: str
    version: str = ""
    quantities: Mapping[str, Discrepancy] = field(default_factory=dict)
    skipped: str = ""

    def __getitem__(self, name: str) -> Discrepancy:
        if name not in self.quantities:
            raise UnknownName(f"quantity of engine {self.name!r}", name, self.quantities)
        return self.quantities[name]


@dataclass(frozen=True, eq=False)
class Verification:
    """The outcome of `compare`.

    Attributes:
        mechanism: its name.
        parameters: values of all parameters.
        coordinates: names of q.
        states: number of states that every engine saw.
        seed: of the random states.
        tolerance: largest relative error that counts as agreement.
        engines: one result for each engine.
    """

    mechanism: str
    parameters: Mapping[str, float]
    coordinates: tuple[str, ...]
    states: int
    seed: int
    tolerance: float
    engines: tuple[EngineResult, ...]

    @property
    def ok(self) -> bool:
        """Whether at least one engine ran, and all that ran agree."""
        ran = [engine for engine in self.engines if not engine.skipped]
        return bool(ran) and all(self._agrees(found) for engine in ran for found in engine.quantities.values())

    def __getitem__(self, name: str) -> EngineResult:
        for engine in self.engines:
            if engine.name == name:
                return engine
        raise UnknownName("engine in this verification", name, [engine.name for engine in self.engines])

    def check(self) -> Verification:
        """Itself where `ok`.

        Raises:
            VerificationError: names the engine, the quantity, the state and both values of the first disagreement.
        """
        for engine in self.engines:
            for name, found in engine.quantities.items():
                if not self._agrees(found):
                    raise VerificationError(self._complaint(engine, name, found))
        if not self.ok:
            reasons = "; ".join(f"{engine.name}: {engine.skipped}" for engine in self.engines)
            raise VerificationError(
                f"nothing was verified, every engine was skipped: {reasons or 'none was asked for'}"
            )
        return self

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and texts, for JSON."""
        return {
            "mechanism": self.mechanism,
            "parameters": dict(self.parameters),
            "states": self.states,
            "seed": self.seed,
            "tolerance": self.tolerance,
            "ok": self.ok,
            "engines": {engine.name: _engine_dict(engine) for engine in self.engines},
        }

    def __str__(self) -> str:
        verdict = "agrees" if self.ok else "DOES NOT AGREE"
        head = (
            f"{self.mechanism!r} {verdict} with independent engines: {self.states} states, tolerance {self.tolerance:g}"
        )
        lines = [head, f"  {'engine':<20}{'quantity':<26}{'max rel':>10}{'median rel':>12}{'max abs':>10}"]
        for engine in self.engines:
            title = f"{engine.name} {engine.version}".strip()
            if engine.skipped:
                lines.append(f"  {title:<20}skipped: {engine.skipped}")
            for name, found in engine.quantities.items():
                numbers = f"{found.max_rel_error:>10.1e}{found.median_rel_error:>12.1e}{found.max_abs_error:>10.1e}"
                lines.append(
                    f"  {title:<20}{_QUANTITIES[name]:<26}{numbers}{'' if self._agrees(found) else '  <- too large'}"
                )
                title = ""
        return "\n".join(lines)

    def _agrees(self, found: Discrepancy) -> bool:
        return bool(found.max_rel_error <= self.tolerance)  # NaN does not agree

    def _complaint(self, engine: EngineResult, name: str, found: Discrepancy) -> str:
        place = ", ".join(f"{key} = {value!r}" for key, value in found.worst.positions.items())
        rates = ", ".join(f"{key}' = {value!r}" for key, value in found.worst.rates.items())
        engine_name = f"{engine.name} {engine.version}".strip()
        return (
            f"{engine_name} and nullbody disagree on {_QUANTITIES[name]} of {self.mechanism!r} by "
            f"{found.max_rel_error:.3g} relative (tolerance {self.tolerance:g}) in state {found.state} of "
            f"{self.states}, seed {self.seed}: {found.theirs.tolist()} against {found.ours.tolist()}. "
            f"State: {place}; {rates}"
        )


def _engine_dict(engine: EngineResult) -> dict[str, Any]:
    """One engine's part of `to_dict`."""
    plain: dict[str, Any] = {"version": engine.version}
    if engine.skipped:
        return {**plain, "skipped": engine.skipped}
    for name, found in engine.quantities.items():
        absolute = "max_abs_force_error" if name == "inverse_dynamics" else "max_abs_error"
        plain[name] = {
            "max_rel_error": found.max_rel_error,
            "median_rel_error": found.median_rel_error,
            absolute: found.max_abs_error,
            "worst_state": found.state,
        }
    return plain
