"""The table of symbolic methods of other tools; light to import, the tools are loaded where they run."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["PEERS", "Peer"]


@dataclass(frozen=True)
class Peer:
    """A symbolic method of another tool.

    Attributes:
        words: what it does, for tables.
        package: name of the package on the index, for `pip install`.
        module: its Python module.
        place: the module of `nullbody.bench.peer` that runs it.
    """

    words: str
    package: str
    module: str
    place: str

    @property
    def missing(self) -> str:
        """Why it cannot run, or nothing."""
        if importlib.util.find_spec(self.module) is not None:
            return ""
        return f"not installed: python -m pip install {self.package}"


def _sympy(words: str) -> Peer:
    return Peer(f"SymPy {words}", "sympy", "sympy", "sympy_method")


def _symengine(words: str) -> Peer:
    return Peer(f"SymEngine {words}", "symengine", "symengine", "symengine_method")


def _casadi(words: str) -> Peer:
    return Peer(f"CasADi {words}", "casadi", "casadi", "casadi_method")


#: The methods by the name of the function that runs them.
PEERS: Mapping[str, Peer] = {
    "gauss_jordan": _sympy("Gauss-Jordan in fixed order, zero test by simplify"),
    "structural": _sympy("Gauss-Jordan in fixed order, structural zero test"),
    "by_value": _sympy("Gauss-Jordan, pivots chosen by value at a state"),
    "nullspace": _sympy("Matrix.nullspace()"),
    "rref": _sympy("Matrix.rref()"),
    "cramer_solve": _sympy("Matrix.cramer_solve (determinants)"),
    "lu_solve": _sympy("Matrix.LUsolve"),
    "domain_nullspace": _sympy("DomainMatrix.nullspace()"),
    "domain_adjugate": _sympy("DomainMatrix.adj_det() C"),
    "symengine_lu": _symengine("LUsolve"),
    "symengine_inverse": _symengine("inv() C"),
    "symengine_determinants": _symengine("det(), one for each entry"),
    "casadi_solve": _casadi("SX solve (QR)"),
    "casadi_nullspace": _casadi("SX nullspace (Householder)"),
    "flint_minors": Peer("FLINT fmpq_mpoly, memoised minors", "python-flint", "flint", "flint_method"),
}
