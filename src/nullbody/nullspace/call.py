"""One call for every matrix: read it, choose rows and columns, factor, return the basis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Expr
from nullbody.nullspace.elimination import eliminate
from nullbody.nullspace.given import Given, checked_columns, checked_tolerance, read
from nullbody.nullspace.minors import LARGEST
from nullbody.nullspace.plan import DEFAULT, SMALL_BLOCK, Plan
from nullbody.nullspace.rank import Echelon
from nullbody.nullspace.result import Form
from nullbody.nullspace.roots import generic_echelon, has_roots
from nullbody.nullspace.scalar import is_zero
from nullbody.nullspace.search import cheapest
from nullbody.nullspace.steps import Sparse
from nullbody.nullspace.symbolic import Rows, SymbolicNullSpace

__all__ = ["METHODS", "null_space"]

#: The methods for exact numbers and expressions: the largest block that each expands by minors.
METHODS = {"auto": SMALL_BLOCK, "minors": LARGEST, "elimination": 0}


def null_space(
    A: Any,
    independent: Sequence[int] | None = None,
    form: Form = "reduced",
    method: str = "auto",
    *,
    prefer: Sequence[int] | None = None,
    search: int = 0,
    tolerance: float | None = None,
) -> Any:
    """The null space of A: a basis N, n x d, with A N = 0.

    Args:
        A: m x n. Exact result: rows of int and Fraction, SymPy matrices, expressions of a graph, `Exact` numbers.
            Rounded result: NumPy arrays (a stack k x m x n gives a `NullSpaceStack`), rows with floats or complex
            numbers, SciPy sparse matrices. Rows that repeat others are found and left out.
        independent: the d = n - rank columns that stay free. By default `prefer` decides; without it the last
            columns that make |B| non-zero, for arrays those that complete pivoting leaves.
        form: "reduced" [-B^-1 C; I], "scaled" |B| times that, "orthogonal", "orthonormal".
        method: "auto"; for exact numbers and expressions "minors" (determinants alone, one reciprocal for each
            irreducible block; blocks up to 14) and "elimination" (fewest operations, but its pivots may vanish
            where |B| does not), "auto" takes minors in blocks up to 6;
            for arrays "complete", "lu", "qr", "svd", "minors", "compiled" (`nullbody.nullspace.numeric`).
        prefer: columns in the order in which they should become independent, as far as they can.
        search: for expressions only, how many other ways of writing the basis to try for fewer operations; each
            takes as long as the first, and common factors are taken out of the cheapest (0: of none). The same number
            gives the same result. Exact numbers leave nothing to search: it is ignored.
        tolerance: for arrays and sparse matrices, the relative size below which a pivot counts as zero; exact numbers
            and expressions need none.

    Returns:
        `NullSpace`: basis, delta, independent, dependent, rows, redundant, repeats, condition, ...

    Raises:
        InputError: ragged A, entries that are no finite numbers, wrong columns, search for arrays, or only 0 is found.
        SingularityError: the chosen columns leave |B| = 0; the message names columns that would do.
    """
    _require(form, search, independent, prefer)
    given, tolerance = read(A), checked_tolerance(tolerance)
    independent = None if independent is None else checked_columns(independent, given.columns, "independent")
    prefer = None if prefer is None else checked_columns(prefer, given.columns, "preferred")
    if search and given.kind in ("array", "sparse"):
        raise InputError("search is for expressions: of an array or a sparse matrix the basis is numbers, leave it out")
    if given.kind == "array":
        from nullbody.nullspace.numeric import array_null_space

        return array_null_space(given.matrix, independent, form, method, prefer=prefer, tolerance=tolerance)
    if given.kind == "sparse":
        from nullbody.nullspace.sparse import sparse_null_space

        return sparse_null_space(given.matrix, independent, form, method, prefer=prefer, tolerance=tolerance)
    if method not in tuple(METHODS):
        raise UnknownName("method", method, METHODS, place="null_space of exact numbers or expressions")
    plan = Plan(largest=METHODS[method])
    space = symbolic_null_space(given, independent, form, plan, prefer=prefer, search=search)
    if not space.independent:
        raise InputError(
            f"A has full column rank {given.columns}: there is nothing but 0 in its null space, no columns would do"
        )
    return space


def _require(form: Form, search: int, independent: Any, prefer: Any) -> None:
    """Raise where arguments of `null_space` make no sense, whatever A is."""
    if form not in get_args(Form):
        raise UnknownName("form", form, get_args(Form), place="null_space")
    if type(search) is not int or search < 0:
        raise InputError(f"search must be a number of trials, 0 or more, not {search!r}")
    if independent is not None and prefer is not None:
        raise InputError("give the independent columns or a preference among columns, not both")


def symbolic_null_space(
    given: Given,
    independent: Sequence[int] | None = None,
    form: Form = "reduced",
    plan: Plan = DEFAULT,
    *,
    prefer: Sequence[int] | None = None,
    search: int = 0,
) -> SymbolicNullSpace:
    """The null space of exact numbers or expressions by a plan; other arguments as `null_space`, columns checked.

    A matrix of full column rank gives a basis without columns here: a mechanism may have no freedom.
    """
    rows, n = given.matrix, given.columns
    found = _echelon(rows, n, prefer)
    chosen = _chosen(independent, n, found)
    dependent = tuple(j for j in range(n) if j not in set(chosen))
    used = [rows[i] for i in found.rows]
    if independent is not None and has_roots(used) and not _regular(used, dependent, chosen):
        raise _singular(rows, chosen, n)

    def made(used: Sequence[Sparse], plan: Plan, basis: Rows | None = None) -> SymbolicNullSpace:
        factors = eliminate(used, dependent, plan)
        if is_zero(factors.delta):
            raise _singular(rows, chosen, n)
        return SymbolicNullSpace(
            form,
            "elimination" if factors.eliminated else "minors",
            chosen,
            dependent,
            found.rows,
            found.redundant,
            factors,
            tuple(rows[i] for i in found.redundant),
            given,
            basis,
        )

    if search and any(isinstance(entry, Expr) for row in used for entry in row.values()):
        return made(used, *cheapest(used, lambda used, plan: made(used, plan).inward(form), plan, search))
    return made(used, plan)


def _echelon(rows: Sequence[Sparse], n: int, prefer: Sequence[int] | None) -> Echelon:
    """Rows that are independent; columns that may be dependent, the preferred ones last."""
    order: Sequence[int] = range(n)
    if prefer is not None:
        order = [j for j in range(n) if j not in prefer] + list(reversed(prefer))
    return generic_echelon(rows, order)


def _chosen(independent: Sequence[int] | None, n: int, found: Echelon) -> tuple[int, ...]:
    if independent is None:
        return tuple(j for j in range(n) if j not in set(found.columns))
    chosen = tuple(independent)
    if len(chosen) != n - found.rank:
        raise InputError(
            f"A has {n} columns and rank {found.rank}: choose {n - found.rank} independent columns, not {len(chosen)}"
        )
    return chosen


def _regular(rows: Sequence[Sparse], dependent: Sequence[int], chosen: Sequence[int]) -> bool:
    return set(generic_echelon(rows, [*dependent, *chosen]).columns) == set(dependent)


def _singular(rows: Sequence[Sparse], chosen: Sequence[int], n: int) -> SingularityError:
    found = generic_echelon(rows, [j for j in range(n) if j not in chosen] + list(reversed(chosen)))
    would_do = [j for j in range(n) if j not in found.columns]
    return SingularityError(
        f"columns {list(chosen)} cannot be the independent ones: the determinant of the others is identically zero; "
        f"columns {would_do} would do"
    )
