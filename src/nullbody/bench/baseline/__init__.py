"""Methods of the literature, each as short as it can be written in NumPy, to test and to measure against."""

from nullbody.bench.baseline.determinant import dai_jones, determinants
from nullbody.bench.baseline.elimination import gauss_jordan, lapack_solve, maggi_kane, wehage_haug
from nullbody.bench.baseline.orthogonal import (
    KimVanderploeg,
    householder,
    kim_vanderploeg,
    liang_lance,
    singh_likins,
    walton_steeves,
)
from nullbody.bench.baseline.sparse import fundamental, triangular, turnback
from nullbody.bench.baseline.table import BASELINES, Baseline, Method

__all__ = [
    "BASELINES",
    "Baseline",
    "KimVanderploeg",
    "Method",
    "dai_jones",
    "determinants",
    "fundamental",
    "gauss_jordan",
    "householder",
    "kim_vanderploeg",
    "lapack_solve",
    "liang_lance",
    "maggi_kane",
    "singh_likins",
    "triangular",
    "turnback",
    "walton_steeves",
    "wehage_haug",
]
