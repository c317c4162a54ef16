"""Which rows of A are kept and which coordinates are independent: the chart in which equations are written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from nullbody.equations.closure import Closures
from nullbody.equations.manifold import Manifold, Sample
from nullbody.equations.mobility import Mobility
from nullbody.errors import InputError, MechanismError, SingularityError, UnknownName
from nullbody.mechanism import Mechanism
from nullbody.nullspace import Echelon, echelon

__all__ = ["Choice", "choose", "dependent"]


@dataclass(frozen=True)
class Choice:
    """A chart.

    Attributes:
        rows: places of the rows of A that are kept, independent on the constraint manifold.
        closures: places of the rows of Phi that close the loops; the others repeat them in every configuration.
        independent: names of the independent coordinates.
        mobility: the count behind it.
    """

    rows: tuple[int, ...]
    closures: tuple[int, ...]
    independent: tuple[str, ...]
    mobility: Mobility


def choose(
    mechanism: Mechanism,
    loops: Closures,
    manifold: Manifold,
    wanted: Sequence[str] | None,
    labels: Sequence[str] | None,
) -> Choice:
    """Rows and independent coordinates, the wanted ones where they are given.

    Raises:
        UnknownName, InputError: wrong names or numbers of them.
        MechanismError: a driver moves what the loops hold.
        SingularityError: the wanted coordinates depend on each other in every configuration.
    """
    names = mechanism.coordinates
    order = sorted(range(len(names)), key=lambda j: names[j] in mechanism.actuated)
    norms = _norms(mechanism, loops)
    form = _echelon(loops, len(loops.A), norms, order)
    holonomic = _echelon(loops, len(loops.Phi), norms, order)
    samples = manifold.samples
    rank = min(form.rank, max((sample.rank for sample in samples), default=form.rank))
    where = next((sample for sample in samples if sample.rank == rank), None)
    if any(entry != 0 for entry in loops.b) and where is not None:
        _check_driven(loops, manifold, where)
    rows = form.rows
    if labels is not None:
        rows = _labelled(loops, labels, rank)
    elif where is not None and (rank < form.rank or where.rank_of(form.rows) < rank):
        rows = tuple(where.independent_rows(rank, norms))
    mobility = Mobility(
        nq=len(names),
        rows=len(loops.A),
        nonholonomic=len(loops.A) - len(loops.Phi),
        rank=rank,
        always=tuple(loops.labels[i] for i in form.redundant if i not in rows),
        closed=tuple(loops.labels[i] for i in form.rows if i not in rows),
        home_rank=samples[0].rank if samples else rank,
        sampled=len(samples),
    )
    chosen = _independent(mechanism, form, where, mobility.nv, wanted)
    closures = sorted({*holonomic.rows, *(i for i in rows if i < len(loops.Phi))})
    return Choice(rows, tuple(closures), chosen, mobility)


def _check_driven(loops: Closures, manifold: Manifold, where: Sample) -> None:
    found = manifold.unfulfilled(where)
    if found is not None:
        row, t = found
        raise MechanismError(
            f"{loops.labels[row]!r} asks for a motion that the other equations do not allow: no rates fulfil all of "
            f"them at t = {t:g} s. Leave it out, drive another coordinate, or give the mechanism a degree of freedom"
        )


def _norms(mechanism: Mechanism, loops: Closures) -> list[int]:
    """Places of the rows |e| = 1. They are kept before all others: loops fix rotations only where they hold."""
    labels = {f"{joint.name} {row}" for joint in mechanism.joints for row in joint.own_rows}
    return [i for i, label in enumerate(loops.labels) if label in labels]


def _echelon(loops: Closures, count: int, norms: Sequence[int], order: Sequence[int]) -> Echelon:
    """The echelon form of the first rows of A with the norms before the others; places in the order of A."""
    if not count:
        return Echelon((), (), ())
    places = [*norms, *(i for i in range(count) if i not in norms)]
    form = echelon([loops.A[i] for i in places], order)
    rows, redundant = (tuple(sorted(places[i] for i in part)) for part in (form.rows, form.redundant))
    return Echelon(rows, form.columns, redundant)


def dependent(chosen: Sequence[str], would_do: Sequence[str]) -> SingularityError:
    """The error for coordinates that can never be the independent ones."""
    return SingularityError(
        f"{', '.join(chosen)} cannot be the independent coordinates in any configuration: they depend on each "
        f"other, |B| is identically zero. {', '.join(would_do)} would do"
    )


def _labelled(loops: Closures, labels: Sequence[str], rank: int) -> tuple[int, ...]:
    for label in labels:
        if label not in loops.labels:
            raise UnknownName("row", label, loops.labels)
    if len(set(labels)) != rank:
        raise InputError(f"{rank} rows are independent: name {rank} of them, not {len(set(labels))}")
    return tuple(sorted(loops.labels.index(label) for label in labels))


def _independent(
    mechanism: Mechanism, form: Echelon, where: Sample | None, nv: int, wanted: Sequence[str] | None
) -> tuple[str, ...]:
    names = mechanism.coordinates
    actuated = list(dict.fromkeys(mechanism.actuated))
    if wanted is None:
        if where is not None:
            columns = where.independent_columns([names.index(name) for name in actuated])
            free = [name for j, name in enumerate(names) if j in columns]
        else:
            free = [name for j, name in enumerate(names) if j not in form.columns]
        leading = [name for name in actuated if name in free]
        return tuple(leading + [name for name in free if name not in leading])
    try:
        wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    except TypeError:
        raise InputError(f"independent must be a list of coordinate names, not {wanted!r}") from None
    for name in wanted:
        if name not in names:
            raise UnknownName("coordinate", name, names)
    if len(set(wanted)) != len(wanted) or len(wanted) != nv:
        raise InputError(f"{mechanism.name!r} has {nv} degrees of freedom: name {nv} coordinates, not {list(wanted)}")
    return wanted
