from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

FALLING = "simulate three_prs --rates s1=0.1 --until 2 --keep"


def test_numbers_are_those_of_the_library(nullbody) -> None:
    import nullbody as library

    start = "--start s1=0.6,s2=0.5,s3=0.6 --rates s2=-0.2"
    found = nullbody(f"simulate three_prs --set l=0.6 {start} --forces F1=0.3 --until 0.2 --json").json
    model = library.build(library.derive(library.catalog.three_prs()), {"l": 0.6})
    state = library.assemble(model, {"s1": 0.6, "s2": 0.5, "s3": 0.6}, v=[0, -0.2, 0])
    expected = library.simulate(model, state, 0.2, u=[0.3, 0, 0])
    assert found["parameters"]["l"] == 0.6
    assert [found["end"][name] for name in model.coordinates] == expected.q[-1].tolist()
    assert found["outcome"] == "COMPLETED"
    assert found["statistics"]["energy_drift"] < 1e-9


def test_early_end_is_named_and_what_was_reached_is_written(nullbody, tmp_path: Path) -> None:
    """Upright, the robot falls into a forward singularity."""
    ended = nullbody(f"{FALLING} -o run.nc --json")
    assert ended.code == 1
    assert ended.json["outcome"] == "SINGULAR_INDEPENDENT_SET"
    assert ended.err.startswith("error: the simulation of 'three_prs' ended at t = 0.6")
    assert ended.err.count("\n") == 1
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as read:
        assert read.t.values[-1] == ended.json["reached"] < 2
        assert read.attrs["outcome"] == "SINGULAR_INDEPENDENT_SET"


def test_summary_for_people(nullbody) -> None:
    ended = nullbody(FALLING)
    assert ended.code == 1
    for word in ("SINGULAR_INDEPENDENT_SET", "energy drift", "closure", "alpha3", "s3_dot", "m/s"):
        assert word in ended.out


def test_samples_go_into_the_file(nullbody, tmp_path: Path) -> None:
    assert nullbody("simulate three_prs --until 0.1 --samples 6 -o run.csv").err == "written to run.csv\n"
    read = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    np.testing.assert_allclose(read["t"], np.linspace(0, 0.1, 6))


@pytest.mark.parametrize("control", ["computed-torque", "feed-forward --gains kp=100,kd=20"])
def test_control_follows_the_paper(nullbody, control: str) -> None:
    found = nullbody(f"simulate three_prs --control {control} --until 0.5 --json").json
    wanted = 0.6 + np.array([0.2, -0.3, -0.2]) * np.sin(0.5)
    np.testing.assert_allclose([found["end"][s] for s in ("s1", "s2", "s3")], wanted, atol=1e-7)


def test_control_to_a_point(nullbody) -> None:
    line = "simulate three_prs --control computed-torque --start s1=0.6,s2=0.6,s3=0.6 --reference s1=0.65 --until 0.5"
    end = nullbody(f"{line} --json").json["end"]
    np.testing.assert_allclose([end[s] for s in ("s1", "s2", "s3")], [0.65, 0.6, 0.6], atol=1e-7)
