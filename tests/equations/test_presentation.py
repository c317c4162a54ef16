from __future__ import annotations

import re

import pytest

from nullbody.equations import Equations, derive
from nullbody.mechanism import Body, Mechanism, Prismatic, Spherical
from tests.mechanisms import four_bar, slider_crank, two_bodies

OUTPUTS = (
    *("Phi", "A", "c", "M", "h", "Q", "T", "U", "delta"),
    *("N", "N_scaled", "gamma", "gamma_scaled", "Mr", "hr", "Br"),
)


def readable(shown: str) -> None:
    """Balanced environments, braces and fences; nothing of Python's left in it."""
    assert shown.startswith("\\begin{aligned}\n")
    assert shown.endswith("\n\\end{aligned}")
    opened = re.findall(r"\\begin\{(\w+)\}", shown)
    assert sorted(opened) == sorted(re.findall(r"\\end\{(\w+)\}", shown))
    assert shown.count(r"\left") == shown.count(r"\right")
    assert shown.count("{") == shown.count("}")
    for relic in ("*", "None", "Expr", "<", "+ -", "- -", "sqrt("):
        assert relic not in shown, relic


@pytest.mark.parametrize("name", OUTPUTS)
def test_latex_of_every_output_is_readable(name: str, three_prs_equations: Equations) -> None:
    readable(three_prs_equations.latex(name))


@pytest.mark.parametrize("mechanism", [four_bar, slider_crank, two_bodies])
def test_latex_of_other_mechanisms_is_readable(mechanism) -> None:
    eq = derive(mechanism())
    for name in OUTPUTS:
        readable(eq.latex(name))


def test_shared_expressions_are_defined_before_their_use(three_prs_equations: Equations) -> None:
    defined: set[str] = set()
    for line in three_prs_equations.latex("N_scaled").splitlines()[1:-1]:
        left, _, right = line.partition("&=")
        assert set(re.findall(r"z_\{\d+\}", right)) <= defined
        defined.add(left.strip())
    assert r"\tilde{N}" in defined


def test_every_shared_expression_is_used(three_prs_equations: Equations) -> None:
    for name in OUTPUTS:
        shown = three_prs_equations.latex(name)
        for symbol in set(re.findall(r"z_\{\d+\}", shown)):
            assert shown.count(symbol) > 1, f"{symbol} of {name} is defined and never used"


def test_a_readable_matrix_has_its_columns(three_prs_equations: Equations) -> None:
    shown = three_prs_equations.latex("Br")
    body = shown.partition(r"\begin{bmatrix}")[2].partition(r"\end{bmatrix}")[0]
    assert [row.strip() for row in body.split(r"\\")] == ["1 & 0 & 0", "0 & 1 & 0", "0 & 0 & 1"]


def test_the_summary_names_everything_and_fits_the_terminal(three_prs_equations: Equations) -> None:
    shown = str(three_prs_equations)
    assert shown.splitlines()[0].startswith("Equations of 'three_prs': nq = 12 coordinates, nc = 9 closures, nv = 3")
    for word in (*three_prs_equations.coordinates, *three_prs_equations.inputs, *OUTPUTS, "leg1", "leg3"):
        assert re.search(rf"\b{word}\b", shown), word
    assert max(len(line) for line in shown.splitlines()) <= 120
    assert repr(three_prs_equations) == "<Equations of 'three_prs': nq = 12, nc = 9, nv = 3>"


def test_a_summary_without_loops_and_inputs() -> None:
    eq = derive(Mechanism("cart", (Body("cart", 1),), (Prismatic("slide", "ground", "cart", ("x",)),)))
    assert "u = none" in str(eq)


def test_a_loop_may_have_a_name_of_several_words() -> None:
    joints = (Prismatic("a", "ground", "a", ("x",), axis="x"), Prismatic("b", "ground", "b", ("y",), axis="x"))
    loop = Spherical("the long pin", "a", "b")
    eq = derive(Mechanism("pair", (Body("a", 1), Body("b", 1)), joints, (loop,)))
    assert "loop the long pin: spherical joint between a and b (x; y z repeats other equations)" in str(eq)
