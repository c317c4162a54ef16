"""The sections beyond the paper: the catalog, motions through singularities, published benchmarks."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import import_module
from importlib.resources import files

import numpy as np
import pytest

from nullbody import Model, build, catalog, derive, simulate
from nullbody.kinematics import consistent
from nullbody.report import Check, Figure, Section, Table, Verdict
from nullbody.report.literature import repeated
from nullbody.report.mechanisms import catalogued
from nullbody.report.reference import PUBLISHED, reference
from nullbody.report.singular import charts


def tables(section: Section) -> list[Table]:
    return [part for part in section.parts if isinstance(part, Table)]


def value(section: Section, words: str) -> Check:
    return next(check for check in section.checks if words in check.what)


def test_every_mechanism_has_a_picture_a_reason_and_a_check(by_key: dict[str, Section]) -> None:
    section = by_key["mechanisms"]
    gallery = next(part for part in section.parts if isinstance(part, Figure))
    counts, times = tables(section)
    assert len(counts.rows) == len(times.rows) == len(catalog.MODELS) == 18
    for entry in catalog.ENTRIES.values():
        assert f"{entry.title}: against multipliers" in str(section.checks)
        row = next(row for row in counts.rows if row[0] == entry.title)
        assert entry.mobility in row[-1] and row[4] == str(entry.degrees_of_freedom)
    assert gallery.svg.count('<g id="axes_') == 18


def test_redundant_rows_are_named(by_key: dict[str, Section]) -> None:
    rows = {row[0]: row for row in tables(by_key["mechanisms"])[0].rows}
    assert "found to repeat others: pin z" in rows["Planar four-bar"][-1]
    assert "where the loops are closed: node5" in rows["Bricard's mechanism (A04)"][-1]


def test_a_wrong_mass_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that gets other parameters than the model does not agree."""
    from nullbody.verify.full_coordinates import MultiplierEngine

    entry = catalog.ENTRIES["slider_crank"]
    right = catalogued(entry, ("multipliers",), 3).worst("multipliers")

    def heavier(mechanism: object, parameters: dict[str, float], labels: object) -> MultiplierEngine:
        return MultiplierEngine(mechanism, {**parameters, "mr": 1.001 * parameters["mr"]}, labels)  # type: ignore[arg-type]

    engines = import_module("nullbody.verify.compare")._ENGINES
    monkeypatch.setitem(engines, "multipliers", heavier)
    wrong = catalogued(entry, ("multipliers",), 3).worst("multipliers")
    assert right is not None and wrong is not None
    assert right < 1e-12 < 1e-6 < wrong


def test_engines_that_are_missing_are_not_run() -> None:
    from nullbody.report import mechanisms as module

    found = catalogued(catalog.ENTRIES["four_bar"], ("multipliers",), 2)
    skipped = replace(found.engines["multipliers"], name="mujoco", quantities={}, skipped="not installed")
    bare = replace(found, engines={**found.engines, "mujoco": skipped})
    checks = module._checks([bare], ("multipliers", "mujoco"))
    assert checks[-1].verdict is Verdict.MISSING
    assert module._time_table([bare], {"four_bar": (0.01, 0.2)}).rows[0][-1] == "-"


def test_all_published_benchmarks_of_the_catalog_are_repeated(by_key: dict[str, Section]) -> None:
    assert {given.mechanism for given in PUBLISHED} == set(catalog.STARTS)
    section = by_key["published"]
    assert len(tables(section)[0].rows) == len(PUBLISHED)
    for given in PUBLISHED:
        check = value(section, f"{given.title}: largest position error")
        assert check.verdict is Verdict.AGREES and check.high == given.digits[0]


def test_every_reference_file_is_used() -> None:
    folder = files("nullbody.report").joinpath("published")
    names = {file.name.removesuffix(".json") for file in folder.iterdir() if file.name.endswith(".json")}
    assert names == {given.mechanism for given in PUBLISHED}
    for name in names:
        motions = json.loads(folder.joinpath(f"{name}.json").read_text(encoding="utf-8"))["motions"]
        shown = {given.motion for given in PUBLISHED if given.mechanism == name}
        assert shown <= set(motions)
        assert name == "n_four_bar" or shown == set(motions)


def test_compared_columns_are_those_of_the_reference() -> None:
    for given in PUBLISHED:
        wanted = reference(given.mechanism, given.motion)
        assert set(given.drawn) <= set(wanted)
        assert len(given.drawn) <= 3


def test_a_wrong_reference_number_turns_red(monkeypatch: pytest.MonkeyPatch) -> None:
    from nullbody.report import literature as module

    given = next(given for given in PUBLISHED if given.mechanism == "bricard")
    assert repeated(given).positions.max() < given.digits[0]
    wrong = {name: values.copy() for name, values in reference("bricard", "cube").items()}
    wrong["P3_x"][5] += 1e-8
    row = next(given for given in PUBLISHED if given.mechanism == "n_four_bar")
    monkeypatch.setattr(module, "reference", lambda name, motion: wrong)
    spoiled = repeated(given)
    monkeypatch.undo()
    check = module._checks([spoiled, repeated(row)])[0]
    assert check.verdict is Verdict.DIFFERS


def test_changes_of_coordinates_are_listed(by_key: dict[str, Section]) -> None:
    start = catalog.starts("chaplygin_sleigh")["backwards"]
    model: Model = build(derive(start.mechanism))
    found = simulate(model, consistent(model, start.q, start.q_dot).state, 5.0, progress=False)
    used = charts(found)
    assert len(used) == found.statistics.switches + 1
    assert used[0].independent == model.independent
    assert np.all(np.diff([chart.since for chart in used]) > 0)
    assert by_key["singular"].numbers["singular.three_prs.switches"] >= 2


def test_timing_of_the_catalog_is_by_mechanism(by_key: dict[str, Section]) -> None:
    numbers = by_key["mechanisms"].numbers
    for name in catalog.MODELS:
        assert 0 < numbers[f"catalog.{name}.derive_seconds"] < 10
        assert numbers[f"catalog.{name}.operations"] > 0
