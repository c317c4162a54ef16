"""LaTeX: equations as a document of their own."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from nullbody.errors import InputError
from nullbody.export.target import check_target, replacement

if TYPE_CHECKING:
    from nullbody.equations import Equations

__all__ = ["write_latex"]

_HEAD = r"""\documentclass[border=10pt,multi=equations]{standalone}
\usepackage{amsmath}
\setcounter{MaxMatrixCols}{%d}
\newenvironment{equations}{}{}
\begin{document}
"""


def write_latex(equations: Equations, path: str | os.PathLike[str], names: Sequence[str] | None = None) -> None:
    """Write outputs as a LaTeX document with one page, as large as it needs, for each of them.

    Args:
        equations: from `derive`.
        path: ends in .tex; a file that is there is replaced. LaTeX needs amsmath and the class standalone.
        names: names of outputs; all of them by default.

    Raises:
        UnknownName, InputError: a name is no output, or there are none.
        OutputError: it cannot be written; what was there before is untouched.
    """
    check_target(path, ".tex")
    chosen = list(equations.outputs if names is None else names)
    if not chosen:
        raise InputError(f"name at least one output, of {', '.join(equations.outputs)}")
    pages = [
        f"\\begin{{equations}}\n$\\displaystyle\n{equations.latex(name)}\n$\n\\end{{equations}}\n" for name in chosen
    ]
    widest = max(10, len(equations.coordinates), len(equations.labels), len(equations.inputs))
    text = _HEAD % widest + "\n".join(pages) + "\\end{document}\n"
    with replacement(path, ".tex") as draft, draft.open("x", encoding="utf-8", newline="\n") as stream:
        stream.write(text)
