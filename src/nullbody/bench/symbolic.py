"""Null spaces of symbols: this package's rows, what other tools are to run, and their rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from nullbody.bench.matrix import Matrix, three_prs_generic, three_prs_trigonometric
from nullbody.bench.own import WAYS, derived
from nullbody.bench.peer import PEERS, Heat, Lap
from nullbody.bench.peer.process import named_matrix
from nullbody.bench.result import Row
from nullbody.bench.settings import Settings
from nullbody.bench.timing import Timing

__all__ = ["ROBOTS", "WRONG", "own_rows", "peer_rows", "referred", "robot_heats", "symbolic_rows"]

#: The 3-PRS by the names that processes know.
ROBOTS: Mapping[str, Callable[[], Matrix]] = {
    "three_prs_generic": three_prs_generic,
    "three_prs_trigonometric": three_prs_trigonometric,
}

#: |A N| / (|A| |N|) above which a result is no null space.
WRONG = 1e-6

#: Methods that may not finish: they begin first, each matrix in a process of its own.
_SLOW = ("cramer_solve", "gauss_jordan", "nullspace", "rref", "domain_nullspace", "domain_adjugate")

#: Parts of the time limit of methods that need another one: the paper's proposed method should finish.
_SHARES = {"cramer_solve": 1.5}


def symbolic_rows(settings: Settings) -> list[Row]:
    """N, N~ and the orthogonal forms of the 3-PRS."""
    return [row for make in ROBOTS.values() for row in own_rows("symbolic", make, tuple(WAYS), settings)]


def own_rows(part: str, make: Callable[[], Matrix], ways: Iterable[str], settings: Settings) -> list[Row]:
    """This package's rows for a matrix; ratios refer to the first."""
    rows: list[Row] = []
    for name in ways:
        way = WAYS[name]
        if way.searched and not settings.search:
            continue
        found = derived(make, way, settings.repeats, settings.patience, settings.search)
        rows.append(
            Row(
                part,
                found.matrix.name,
                f"nullbody: {way.words}",
                "ours",
                time=found.time,
                ratio=found.time.median / rows[0].time.median if rows and rows[0].time else 1.0,
                reference=not rows,
                operations=found.operations.arithmetic,
                residual=found.residual,
                orthogonality=found.orthogonality if way.form.startswith("ortho") else None,
                note=f"best of {settings.search} ways of writing" if way.searched else "",
            )
        )
    return rows


def robot_heats(settings: Settings) -> list[Heat]:
    """Every method of every tool on both matrices of the 3-PRS."""
    chosen = settings.peers or PEERS
    slow = [(name, (matrix,)) for name in _SLOW if name in chosen for matrix in ROBOTS]
    fast = [(name, tuple(ROBOTS)) for name in PEERS if name in chosen and name not in _SLOW]
    return [Heat(name, matrices, _SHARES.get(name, 1) * settings.limit) for name, matrices in slow + fast]


def peer_rows(part: str, laps: Mapping[tuple[str, str], Lap], own: Sequence[Row]) -> list[Row]:
    """The rows of other tools, in the order of `PEERS`, with ratios to this package's rows."""
    order = list(PEERS)
    matrices: dict[str, str] = {}
    for name, _ in laps:
        matrices.setdefault(name, named_matrix(name).name)
    found = []
    for (name, method), lap in sorted(laps.items(), key=lambda entry: order.index(entry[0][1])):
        ratio, bound = referred(lap, matrices[name], own)
        time = None if lap.seconds is None else Timing(lap.seconds, 0.0)
        found.append(
            Row(
                part,
                matrices[name],
                PEERS[method].words,
                "peer",
                time=time,
                ratio=ratio,
                bound=bound,
                operations=lap.operations,
                residual=lap.residual,
                note=_note(lap),
            )
        )
    return found


def referred(lap: Lap, matrix: str, own: Sequence[Row]) -> tuple[float | None, bool]:
    """How many times longer than this package, and whether that is only a lower bound: it was stopped."""
    reference = next((row.time for row in own if row.matrix == matrix and row.reference), None)
    seconds = lap.limit if lap.stopped else lap.seconds
    if reference is None or seconds is None:
        return None, False
    return seconds / reference.median, lap.stopped


def _note(lap: Lap) -> str:
    if lap.seconds is None or lap.note:
        return lap.note
    if lap.residual is None:
        return "wrong: not finite at the sample"
    return f"wrong: |A N| = {lap.residual:.1g}" if lap.residual > WRONG else ""
