"""The table of numeric baselines."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nullbody.bench.baseline.determinant import dai_jones, determinants
from nullbody.bench.baseline.elimination import gauss_jordan, lapack_solve, maggi_kane, wehage_haug
from nullbody.bench.baseline.orthogonal import (
    KimVanderploeg,
    householder,
    liang_lance,
    singh_likins,
    walton_steeves,
)
from nullbody.bench.baseline.sparse import fundamental, triangular, turnback
from nullbody.typing import FloatArray

__all__ = ["BASELINES", "Baseline", "Method"]

#: A (m x n, the last n - m columns independent) -> N (n x (n - m)).
Method = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class Baseline:
    """A method to measure against.

    Attributes:
        begin: gives the method for a new sequence of matrices; most of them remember nothing.
        kind: what its basis is: the identity in "fixed" columns or in those that it "chooses", "orthonormal", "sparse".
        source: where it comes from.
    """

    begin: Callable[[], Method]
    kind: Literal["fixed", "chosen", "orthonormal", "sparse"]
    source: str


def _stateless(method: Method) -> Callable[[], Method]:
    return lambda: method


def _svd(A: FloatArray) -> FloatArray:
    """SciPy's null_space."""
    from scipy.linalg import null_space

    found: FloatArray = np.asarray(null_space(A))
    return found


#: Numeric baselines by name, from the paper's on.
BASELINES: Mapping[str, Baseline] = {
    "Gauss-Jordan": Baseline(_stateless(gauss_jordan), "fixed", "the paper's conventional method"),
    "determinants": Baseline(_stateless(determinants), "fixed", "the paper's proposed method [11]"),
    "Dai-Jones cofactors": Baseline(_stateless(dai_jones), "fixed", "Dai, Jones 2002"),
    "numpy.linalg.solve": Baseline(_stateless(lapack_solve), "fixed", "LAPACK gesv"),
    "Maggi-Kane": Baseline(_stateless(maggi_kane), "fixed", "Laulusa, Bauchau 2008"),
    "Wehage-Haug": Baseline(_stateless(wehage_haug), "chosen", "Wehage, Haug 1982"),
    "Liang-Lance": Baseline(_stateless(liang_lance), "orthonormal", "Liang, Lance 1987"),
    "Kim-Vanderploeg": Baseline(KimVanderploeg, "chosen", "Kim, Vanderploeg 1986"),
    "numpy.linalg.qr": Baseline(_stateless(householder), "orthonormal", "LAPACK geqrf"),
    "Singh-Likins": Baseline(_stateless(singh_likins), "orthonormal", "Singh, Likins 1985"),
    "scipy.linalg.null_space": Baseline(_stateless(_svd), "orthonormal", "SciPy"),
    "Walton-Steeves": Baseline(_stateless(walton_steeves), "orthonormal", "Walton, Steeves 1969"),
    "turnback": Baseline(_stateless(turnback), "sparse", "Berry et al. 1985"),
    "Coleman-Pothen fundamental": Baseline(_stateless(fundamental), "sparse", "Coleman, Pothen 1987"),
    "Coleman-Pothen triangular": Baseline(_stateless(triangular), "sparse", "Coleman, Pothen 1987"),
}
