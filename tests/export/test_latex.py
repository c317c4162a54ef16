from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from nullbody import Equations, InputError, UnknownName
from nullbody.export import write_latex


def environments_close(text: str) -> bool:
    """Whether every \\begin{x} meets its \\end{x}, and every brace its partner."""
    waiting: list[str] = []
    for kind, name in re.findall(r"\\(begin|end)\{(\w+)\}", text):
        if kind == "begin":
            waiting.append(name)
        elif not waiting or waiting.pop() != name:
            return False
    return not waiting and text.count("{") == text.count("}")


def test_document_is_whole(equations: Equations, folder: Path) -> None:
    write_latex(equations, folder / "all.tex")
    text = (folder / "all.tex").read_text(encoding="utf-8")
    assert environments_close(text)
    assert text.count(r"\begin{equations}") == len(equations.outputs)
    assert r"\setcounter{MaxMatrixCols}{12}" in text  # amsmath alone stops at 10 columns


def test_chosen_outputs_in_their_order(equations: Equations, folder: Path) -> None:
    write_latex(equations, folder / "two.tex", ["delta", "N_scaled"])
    text = (folder / "two.tex").read_text(encoding="utf-8")
    assert text.index(equations.latex("delta")) < text.index(equations.latex("N_scaled"))
    assert text.count(r"\begin{aligned}") == 2


def test_bad_names_leave_nothing(equations: Equations, folder: Path) -> None:
    with pytest.raises(UnknownName, match="N_scaled"):
        write_latex(equations, folder / "run.tex", ["N_scald"])
    with pytest.raises(InputError, match="at least one"):
        write_latex(equations, folder / "run.tex", [])
    assert list(folder.iterdir()) == []


def test_latex_compiles_it(equations: Equations, folder: Path) -> None:
    latex, find = shutil.which("pdflatex"), shutil.which("kpsewhich")
    if not (latex and find and subprocess.run([find, "standalone.cls"], capture_output=True).stdout):
        pytest.skip("needs pdflatex with the class standalone")
    write_latex(equations, folder / "all.tex")
    command = [latex, "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert f"({len(equations.outputs)} pages" in done.stdout
    assert "Overfull" not in done.stdout


@pytest.mark.parametrize("text", [r"\begin{a}", r"\begin{a}\begin{b}\end{a}\end{b}", "{", r"\end{a}"])
def test_the_check_can_fail(text: str) -> None:
    assert not environments_close(text)
