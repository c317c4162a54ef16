"""The null space of arrays of numbers, one or a stack."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError, UnknownName
from nullbody.nullspace.numeric.chart import Chart, Request
from nullbody.nullspace.numeric.equilibrate import Matrices
from nullbody.nullspace.numeric.method import METHODS, Found
from nullbody.nullspace.numeric.rank import others
from nullbody.nullspace.numeric.result import ArrayNullSpace
from nullbody.nullspace.numeric.stack import NullSpaceStack
from nullbody.nullspace.result import FORMS, Form

__all__ = ["array_null_space"]


def array_null_space(
    A: ArrayLike,
    independent: Sequence[int] | None = None,
    form: Form = "reduced",
    method: str = "auto",
    *,
    prefer: Sequence[int] | None = None,
    tolerance: float | None = None,
) -> ArrayNullSpace | NullSpaceStack:
    """The null space of a matrix (m, n) of numbers, or of every matrix of a stack (k, m, n) of one rank.

    float32 and complex64 results keep their type, integers become float64; A N = 0 without conjugation, and the
    orthogonal forms mean N^H N. Rows are scaled before anything is compared with zero, so that scaling rows of A
    changes nothing.

    Args:
        A: the matrix or the stack. An empty stack (0, m, n) gives an empty result of the rank that the number of
            independent columns leaves, min(m, n - 1) at most; of rank m where no columns are given.
        independent: the d = n - rank columns that stay free, for all matrices of a stack. By default complete pivoting
            chooses, for each matrix on its own.
        form: see `nullbody.nullspace.result.FORMS`.
        method:
            "complete": elimination with complete pivoting, on the whole stack at once.
            "lu": LAPACK's pivoted LU of B.
            "qr", "svd": an orthonormal basis first, by Householder QR of A^H or by singular values: accurate also in
                a chart with |B| near 0, in the forms "orthogonal" and "orthonormal".
            "minors": by determinants (slow; for comparison).
            "compiled": a generated kernel for the stack's zero pattern, in one chart that is good for most; matrices
                where it is not good are done once more by "complete".
            "auto": "complete"; where columns are given or preferred "lu", or "qr" for the orthogonal forms.
        prefer: columns in the order in which they should stay independent. Each is honoured while the condition of N
            stays below 1e3 times what complete pivoting gives.
        tolerance: pivots and singular values below this multiple of the Frobenius norm of A with scaled rows count as
            zero; eps max(m, n, 10) by default. Doubtful decisions show in `gap` and in the repr.

    Raises:
        InputError: A or an argument makes no sense, matrices of a stack differ in rank, or only 0 is in the null space.
        SingularityError: |B| = 0 to rounding; the message names columns that would do.
    """
    matrices = Matrices.of(A)
    request = Request.of(matrices, independent, prefer, tolerance)
    if form not in FORMS:
        raise UnknownName("form", form, FORMS)
    if method not in ("auto", "compiled", *METHODS):
        raise UnknownName("method", method, ("auto", "compiled", *METHODS))
    if method == "auto":
        chosen = independent is not None or bool(prefer)
        method = ("qr" if form in ("orthogonal", "orthonormal") else "lu") if chosen else "complete"
    stack = NullSpaceStack(form, method, matrices, _found(matrices, request, method), request.tolerance)
    return stack[0] if matrices.single else stack


def _found(matrices: Matrices, request: Request, method: str) -> Found:
    if len(matrices) == 0:
        return _empty(matrices, request)
    if method == "compiled":
        from nullbody.nullspace.numeric.compiled import compiled

        return compiled(matrices, request)
    return METHODS[method](matrices, request)


def _empty(matrices: Matrices, request: Request) -> Found:
    """The result for an empty stack."""
    m, n = matrices.shape
    free = n - m if request.independent is None else len(request.independent)
    if not 0 < free <= n or n - free > m:
        raise InputError(f"an empty stack of {m} x {n} matrices shows no rank that leaves {max(free, 0)} columns free")
    independent = np.zeros((0, free), np.intp)
    chart = Chart(independent, others(independent, n), np.zeros((0, n - free), np.intp))
    return Found(chart, np.zeros((0, n, free), matrices.scaled.dtype))
