"""Tables: what is rounding in a position is 0, what is small in a measure stays."""

from __future__ import annotations

import pytest

from nullbody.cli.output import ROUNDING, print_json, print_table


@pytest.mark.parametrize(
    ("smallest", "value", "shown"),
    [
        (ROUNDING, -9.9e-15, "0"),
        (ROUNDING, 1.1e-14, "1.1e-14"),
        (ROUNDING, -0.0, "0"),
        (ROUNDING, float("nan"), "nan"),
        (0.0, 1e-16, "1e-16"),
        (0.0, -0.0, "0"),
    ],
)
def test_small_numbers(smallest: float, value: float, shown: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_table(("name", "value"), [("it", value)], smallest=smallest)
    assert capsys.readouterr().out.split()[-1] == shown


def test_json_keeps_all_digits(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"s1": -9.9e-15})
    assert capsys.readouterr().out == '{\n  "s1": -9.9e-15\n}\n'


def test_upright_links_are_exactly_upright(nullbody) -> None:
    shown = nullbody("inverse three_prs --at s1=0.6,s2=0.6,s3=0.6").out
    words = {line.split()[0]: line.split()[1] for line in shown.splitlines() if len(line.split()) > 1}
    assert [words[name] for name in ("x", "psi", "phi")] == ["0", "0", "0"]
