"""summary.json: stable keys, no NaN, null for what is missing."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

from nullbody.catalog import MODELS
from nullbody.report import Section
from nullbody.report.reference import PUBLISHED
from nullbody.report.summary import summary_text

CATALOG = [f"catalog.{name}.{key}" for name in MODELS for key in ("operations", "derive_seconds", "build_seconds")]
BENCHMARKS = [
    f"published.{given.mechanism}.{given.motion}.{key}"
    for given in PUBLISHED
    for key in ("position_error", "rate_error", "energy_drift", "seconds")
]
KEYS = [
    *CATALOG,
    *BENCHMARKS,
    "appendix.exact",
    "build.cold_seconds",
    "build.warm_seconds",
    "catalog.gap",
    "catalog.max_rel_error.mujoco",
    "catalog.max_rel_error.multipliers",
    "catalog.max_rel_error.pinocchio",
    "constraint_residual.free",
    "constraint_residual.max",
    "constraint_residual.newton",
    "constraint_residual.projected",
    "derive.operations",
    "derive.seconds",
    "errata.eq41_error",
    "errata.eq41_force_error",
    "errata.gravity_sign_error",
    "errata.missing_coupling_error",
    "errata.missing_coupling_force_error",
    "errata.ml2_over_3_acceleration_error",
    "errata.ml2_over_3_force_error",
    "forward_dynamics.max_rel_error.mujoco",
    "forward_dynamics.max_rel_error.pinocchio",
    "inverse_dynamics.max_abs_force_error.mujoco",
    "inverse_dynamics.max_abs_force_error.pinocchio",
    "nullspace.numeric_ns",
    "nullspace.numeric_ns_8_wide",
    "nullspace.numeric_ns_from_matrix",
    "nullspace.numeric_ns_from_matrix_8_wide",
    "nullspace.numeric_ns_from_python",
    "nullspace.numeric_ratio_vs_gauss_jordan",
    "nullspace.numeric_ratio_vs_native_gauss_jordan",
    "nullspace.symbolic_ratio_vs_cramer_solve",
    "nullspace.symbolic_ratio_vs_gauss_jordan",
    "nullspace.symbolic_ratio_vs_gauss_jordan_by_value",
    "nullspace.symbolic_ratio_vs_gauss_jordan_is_lower_bound",
    "nullspace.symbolic_seconds",
    "reactions.max_rel_error.mujoco",
    "reactions.max_rel_error.pinocchio",
    "singular.n_four_bar.crossings",
    "singular.n_four_bar.energy_drift",
    "singular.n_four_bar.max_difference",
    "singular.three_prs.energy_drift",
    "singular.three_prs.max_difference",
    "singular.three_prs.switches",
    "tracking.amplification.0.5",
    "tracking.amplification.1",
    "tracking.amplification.1.75",
    "tracking.closed_loop_max_error",
    "tracking.feedback_only_max_error",
    "tracking.open_loop_growth_rate",
    "tracking.open_loop_time_to_1mm",
    "tracking.shortcut_max_error",
]


def leaves(nested: dict[str, Any], path: str = "") -> list[str]:
    names = []
    for key, value in nested.items():
        here = f"{path}.{key}".lstrip(".")
        names += leaves(value, here) if isinstance(value, dict) else [here]
    return names


def test_keys_are_the_golden_ones(made: list[Section]) -> None:
    assert sorted(leaves(json.loads(summary_text(made, {})))) == sorted(KEYS)


def test_dots_nest_and_what_is_not_finite_is_null() -> None:
    numbers = {"a.b": math.nan, "a.c": np.float64(2.0), "a.d.e": np.bool_(True), "f": [math.inf, 1]}
    section = Section("one", "One", (), numbers=numbers)
    text = summary_text([section], {"versions": {"x": None}})
    assert "NaN" not in text and "Infinity" not in text
    assert json.loads(text) == {
        "a": {"b": None, "c": 2.0, "d": {"e": True}},
        "f": [None, 1],
        "versions": {"x": None},
    }
