"""nullbody export c: the folder that the library writes, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

import nullbody as library
from nullbody.export import write_c


def test_folder_is_that_of_the_library(nullbody, tmp_path: Path) -> None:
    found = nullbody("export c four_bar -o there --set crank=2.2 --real float --prefix fb --json").json
    model = library.build(library.derive(library.catalog.mechanism("four_bar")), {"crank": 2.2})
    written = write_c(model, tmp_path / "expected", real="float", prefix="fb")
    assert [Path(file).name for file in found["files"]] == [path.name for path in written.files]
    assert (found["prefix"], found["cortex_m7"]) == ("fb", None)
    for file, path in zip(found["files"], written.files, strict=True):
        assert (tmp_path / file).read_bytes() == path.read_bytes()


def test_independent_coordinates_are_passed_on(nullbody, tmp_path: Path) -> None:
    assert nullbody("export c three_prs -o there --independent y,psi,phi").code == 0
    assert "v[3], independent rates: y_dot [m/s], psi_dot [rad/s], phi_dot [rad/s]" in (
        tmp_path / "there" / "three_prs.h"
    ).read_text(encoding="utf-8")


def test_sizes_are_shown(nullbody) -> None:
    pytest.importorskip("ziglang")
    found = nullbody("export c four_bar -o there --size --json").json["cortex_m7"]
    assert found["ram"] == 0
    assert found["flash"] > found["functions"]["four_bar_kernel_forward_dynamics"] > 0
    assert str(found["flash"]) in nullbody("export c four_bar -o there --size").out


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("export", "Missing command. See nullbody export --help"),
        ("export d", "No such command 'd'"),
        ("export c four_bar", "Missing option '--out' / '-o'. See nullbody export c --help"),
        ("export c four_bar -o there --real half", "double or float, not for 'half'"),
        ("export c four_bar -o there --prefix 4bar", "such as 'n_4bar'"),
        ("export c four_ba -o there", "did you mean 'four_bar'"),
        ("export c four_bar -o there --set l9=1", "there is no parameter 'l9'"),
    ],
)
def test_bad_input(nullbody, tmp_path: Path, line: str, why: str) -> None:
    ended = nullbody(line)
    assert (ended.code, ended.out) == (2, "")
    assert why in ended.err
    assert not list(tmp_path.iterdir())
