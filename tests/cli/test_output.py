"""Tables: what is rounding in a position is 0, what is small in a measure stays."""

from __future__ import annotations

import pytest

from nullbody.cli.output import print_json, print_table


@pytest.mark.parametrize(
    ("columns", "value", "shown"),
    [
        (("coordinate", "value"), -9.9e-15, "0"),
        (("input", "value"), 1.1e-14, "1.1e-14"),
        (("t [s]", "F1 [N]"), 3e-17, "0"),
        (("name", "start"), -0.0, "0"),
        (("name", "start"), float("nan"), "nan"),
        (("singularity", "measure"), 1e-16, "1e-16"),
        (("parameter", "default"), 1e-15, "1e-15"),
    ],
)
def test_small_numbers(columns, value: float, shown: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_table("", columns, [("it", value)])
    assert capsys.readouterr().out.split()[-1] == shown


def test_json_keeps_all_digits(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"s1": -9.9e-15})
    assert capsys.readouterr().out == '{\n  "s1": -9.9e-15\n}\n'


def test_upright_links_are_exactly_upright(nullbody) -> None:
    shown = nullbody("inverse three_prs --at s1=0.6,s2=0.6,s3=0.6").out
    words = {line.split()[0]: line.split()[1] for line in shown.splitlines() if len(line.split()) > 1}
    assert [words[name] for name in ("x", "psi", "phi")] == ["0", "0", "0"]
