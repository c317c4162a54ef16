"""What the benchmark finds: rows of figures, nothing formatted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from nullbody.bench.settings import Settings
from nullbody.bench.timing import Timing

__all__ = ["Accuracy", "Benchmark", "Pair", "Row", "Worst"]


@dataclass(frozen=True)
class Row:
    """One method on one matrix.

    Attributes:
        part: key of `PARTS`.
        matrix: name of the matrix.
        method: what was run.
        kind: whose it is.
        time: for one null space; nothing where it did not finish.
        ratio: how many times longer than this package's row that `Row.reference` marks.
        bound: whether the ratio is only known to be more: the method was stopped.
        reference: whether ratios of this matrix refer to this row.
        operations: arithmetic ones for N, shared parts once.
        residual: max |A N| / (|A| |N|).
        orthogonality: largest |cosine| between two columns.
        nonzeros: entries of N that are not 0.
        note: why there is no result, or what to know about it.
    """

    part: str
    matrix: str
    method: str
    kind: Literal["ours", "baseline", "peer", "published"]
    time: Timing | None = None
    ratio: float | None = None
    bound: bool = False
    reference: bool = False
    operations: int | None = None
    residual: float | None = None
    orthogonality: float | None = None
    nonzeros: int | None = None
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The row for JSON: time as `seconds` and `spread`, nothing that is unknown."""
        found = {key: value for key, value in vars(self).items() if key != "time" and value not in (None, "", False)}
        if self.time is not None:
            found |= {"seconds": self.time.median, "spread": self.time.spread}
        return found


@dataclass(frozen=True)
class Accuracy:
    """One method near |B| = 0.

    Attributes:
        method: what was run.
        kind: whose it is.
        errors: sine of the angle between its subspace and the exact one, by distance [m]; 1 where it failed.
        residuals: max |A N| / (|A| |N|), by distance; NaN where it failed.
        orthogonality: largest |cosine| between two columns, by distance.
    """

    method: str
    kind: Literal["ours", "baseline"]
    errors: Mapping[float, float]
    residuals: Mapping[float, float]
    orthogonality: Mapping[float, float]


@dataclass(frozen=True)
class Worst:
    """The largest errors of a method over many random regular states of the 3-PRS.

    Attributes:
        method: what was run.
        residual: max |A N| / (|A| |N|), over `states` of them.
        states: how many.
        error: the same of the subspace error, over the first `exact` of them.
        exact: how many were compared with exact arithmetic.
    """

    method: str
    residual: float
    states: int
    error: float
    exact: int


@dataclass(frozen=True)
class Pair:
    """A line of the paper's tables: the conventional method against the proposed one.

    Attributes:
        table: 3 (symbols) or 4 (numbers).
        tool: in which both run.
        conventional: seconds by elimination; where `bound` is set it did not finish and would take more.
        proposed: seconds by determinants.
        bound: see there.
        note: what to know about it.
    """

    table: int
    tool: str
    conventional: float
    proposed: float
    bound: bool = False
    note: str = ""

    @property
    def ratio(self) -> float:
        """How many times faster the proposed method is."""
        return self.conventional / self.proposed


@dataclass(frozen=True)
class Benchmark:
    """Everything that was found.

    Attributes:
        settings: how much was run.
        rows: figures of the parts "symbolic", "numeric", "chains", "random".
        pairs: the paper's tables 3 and 4.
        accuracy: of the part "accuracy".
        worst: likewise.
        deltas: |B| by distance [m] from the singular state.
        facts: machine, versions, run time.
        missing: tools that are not installed, with how to install them.
    """

    settings: Settings
    rows: tuple[Row, ...]
    pairs: tuple[Pair, ...]
    accuracy: tuple[Accuracy, ...]
    worst: tuple[Worst, ...]
    deltas: Mapping[float, float]
    facts: Mapping[str, str]
    missing: Mapping[str, str]

    def of(self, part: str, matrix: str | None = None) -> Iterator[Row]:
        """The rows of a part, of one matrix or all."""
        return (row for row in self.rows if row.part == part and matrix in (None, row.matrix))

    def to_dict(self) -> dict[str, Any]:
        """The same as nested dictionaries and lists, for JSON."""
        return {
            "facts": dict(self.facts),
            "missing": dict(self.missing),
            "settings": asdict(self.settings),
            "rows": [row.to_dict() for row in self.rows],
            "paper": [{**vars(pair), "ratio": pair.ratio} for pair in self.pairs],
            "accuracy": [
                {
                    "method": entry.method,
                    "kind": entry.kind,
                    "distances": [
                        {
                            "distance": distance,
                            "delta": self.deltas[distance],
                            "subspace_error": error,
                            "residual": entry.residuals[distance],
                            "orthogonality": entry.orthogonality[distance],
                        }
                        for distance, error in entry.errors.items()
                    ],
                }
                for entry in self.accuracy
            ],
            "worst": [asdict(entry) for entry in self.worst],
        }
