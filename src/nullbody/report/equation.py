"""Section: the equations, how large they are, and how long they take."""

from __future__ import annotations

from nullbody.equations import Equations, shape
from nullbody.equations.presentation import latex_definition
from nullbody.report.case import Case
from nullbody.report.section import Check, Listing, Section, Table, Text

__all__ = ["equation"]

_DERIVE, _COLD, _WARM = 0.3, 0.5, 0.02  # s, what is required on two slow cores


def equation(case: Case) -> Section:
    """Sizes, operation counts, LaTeX, and the times to derive and to build."""
    equations, timing = case.equations, case.timing
    column = [row[0] for row in equations["N_scaled"]]
    return Section(
        "equations",
        "The equations",
        (
            Text(
                "Φ(<i>q</i>) = 0 are the closures and <i>A</i> = ∂Φ/∂<i>q</i>. The null space <i>N</i> with <i>A "
                "N</i> = 0 gives all rates from the three sliders' rates, <i>q'</i> = <i>N v</i> and <i>q''</i> = "
                "<i>N v'</i> + γ, and removes the multipliers: <i>N</i>ᵀ<i>M N v'</i> + <i>N</i>ᵀ(<i>h</i> + "
                "<i>M</i> γ) = <i>F</i> [42]. <i>N_scaled</i> = Δ <i>N</i> with Δ = |<i>B</i>| is the paper's form "
                "without any division [13]."
            ),
            *_sizes(equations),
            Table(
                ("step", ">found", ">limit"),
                (
                    ("derive: mechanism to equations", f"{1e3 * timing.derive:.0f} ms", f"{1e3 * _DERIVE:.0f} ms"),
                    ("build: compile all kernels, empty cache", f"{1e3 * timing.cold:.0f} ms", f"{1e3 * _COLD:.0f} ms"),
                    ("build: kernels from the cache", f"{1e3 * timing.warm:.1f} ms", f"{1e3 * _WARM:.0f} ms"),
                ),
                "Least of three fresh Python processes, derive at its first call.",
            ),
            Listing("print(equations)", str(equations)),
            Listing("LaTeX of Δ = |B|", equations.latex("delta")),
            Listing("LaTeX of the first column of N_scaled", latex_definition("N_scaled", column)),
            Listing("LaTeX of A", equations.latex("A")),
        ),
        (
            Check.at_most("Derive the equations", timing.derive, _DERIVE, "s", "required"),
            Check.at_most("Build, empty cache", timing.cold, _COLD, "s", "required"),
            Check.at_most("Build, from the cache", timing.warm, _WARM, "s", "required"),
        ),
        {
            "derive.seconds": timing.derive,
            "derive.operations": equations.operations().arithmetic,
            "build.cold_seconds": timing.cold,
            "build.warm_seconds": timing.warm,
        },
    )


def _sizes(equations: Equations) -> tuple[Table, Table]:
    """Operation counts of the outputs and of the kernels."""
    rows, kernels = [], []
    for name in equations.outputs:
        size = " x ".join(str(n) for n in shape(equations[name])) or "1"
        n = equations.operations(name)
        rows.append((name, size, str(n.add), str(n.mul), str(n.div), str(n.trig)))
    for name in equations.routines:
        n = equations.routine_operations(name)
        kernels.append((name, str(n.arithmetic), str(n.div), str(n.trig)))
    return (
        Table(
            ("output", ">size", ">+", ">×", ">÷", ">sin, cos"),
            tuple(rows),
            "Operations of each output alone, shared sub-expressions counted once. All together need "
            f"{equations.operations()} operations: most of the work is common.",
        ),
        Table(
            ("kernel", ">operations", ">÷", ">sin, cos"),
            tuple(kernels),
            "What is compiled to native code. Nothing divides by a quantity that vanishes at a regular state.",
        ),
    )
