"""The test program in C: all functions at a stored state, against stored numbers of the LLVM kernels."""

from __future__ import annotations

from collections.abc import Iterable
from string import Template

import numpy as np

from nullbody.export.c.face import faces
from nullbody.export.c.limits import LIMITS
from nullbody.export.c.subject import Subject
from nullbody.export.c.text import title
from nullbody.export.c.trial import Reference, Trial
from nullbody.kernels.c99 import c_constant, call_text
from nullbody.tolerances import CLOSED_STEP

__all__ = ["check_program"]

_COLUMNS = 4
_NUDGE = 2.0**-9  # [m, rad] that opens the loops
_STEPS = 8  # of Newton, that close them where it can

_PROGRAM = Template(
    """/* $TITLE.
 *
 * Every function at a stored state, against what nullbody's own kernels found there. Distances are in ulp of the
 * largest entry of a result. The bound is 4 ulp, and twice what the result moves when every operation is off by up
 * to half an ulp, as rounding is. The program ends with 1 where a result is beyond its bound or a status is wrong.
 */

#include "$P.h"

#include <float.h>
#include <stddef.h>
#include <stdio.h>

$DATA
static double worst = 0.0;

static int compared(const char *name, const $R *found, const $R *expected, int n, $R ulp, double bound)
{
    double farthest = 0.0;
    int bad = 0;
    for (int k = 0; k < n; k++)
    {
        const double distance = ((double)found[k] - (double)expected[k]) / (double)ulp;
        const double size = (distance < 0.0) ? -distance : distance;
        if (!(size <= bound))
        {
            bad = 1;
        }
        if (!(size <= farthest))
        {
            farthest = size;
        }
    }
    if (!(farthest <= worst))
    {
        worst = farthest;
    }
    (void)printf("%-44s %10.2f ulp, bound %g%s\\n", name, farthest, bound, (bad != 0) ? "  WRONG" : "");
    return bad;
}

static int expected_status(const char *name, ${P}_status found, ${P}_status expected)
{
    const int bad = (found == expected) ? 0 : 1;
    if (bad != 0)
    {
        (void)printf("%-44s returns: %s; it should: %s  WRONG\\n", name, ${P}_message(found), ${P}_message(expected));
    }
    return bad;
}

$CHECKS
int main(void)
{
    int bad = 0;
$CALLS
    (void)printf("worst distance: %.2f ulp; %d wrong\\n", worst, bad);
    return (bad == 0) ? 0 : 1;
}
"""
)


def check_program(subject: Subject, trial: Trial) -> str:
    """The text of <prefix>_test.c."""
    used = [name for name, values in trial.inputs.items() if len(values) and _is_used(subject, trial, name)]
    data = [_array(name, trial.inputs[name], subject) for name in used]
    data += [
        _array(_key(r), r.values, subject)
        for r in (*trial.references, *(r for found in trial.safe.values() for r in found))
    ]
    checks = {f"check_{name}": _kernel(subject, trial, name) for name in subject.programs}
    checks |= {f"check_safe_{face.name}": _face(subject, trial, face.name) for face in faces(subject)}
    if subject.model.closure_labels:
        checks["check_safe_loops"] = _loops(subject, trial)
    checks = {name: lines for name, lines in checks.items() if lines}
    functions = [
        "\n".join([f"static int {name}(void)", "{", "    int bad = 0;", *lines, "    return bad;", "}", ""])
        for name, lines in checks.items()
    ]
    return _PROGRAM.substitute(
        TITLE=title(subject),
        P=subject.prefix,
        R=subject.real,
        DATA="".join(data),
        CHECKS="\n".join(functions),
        CALLS="\n".join(f"    bad += {name}();" for name in checks),
    )


def _is_used(subject: Subject, trial: Trial, key: str) -> bool:
    """Whether a call reads this input."""
    reads = {trial.group(program, name) for program in subject.programs.values() for name, _ in program.inputs}
    return key in reads


def _key(reference: Reference) -> str:
    return f"{reference.routine}_{reference.name}"


def _array(name: str, values: Iterable[float], subject: Subject) -> str:
    texts = [c_constant(float(x), subject.real) for x in values]
    rows = [", ".join(texts[k : k + _COLUMNS]) for k in range(0, len(texts), _COLUMNS)]
    joined = ",\n    ".join(rows)
    return f"static const {subject.real} data_{name}[{len(texts)}] = {{\n    {joined}\n}};\n\n"


def _compared(subject: Subject, reference: Reference, found: str, label: str) -> str:
    ulp = c_constant(reference.ulp, subject.real)
    expected = f"data_{_key(reference)}"
    arguments = [f'"{label}"', found, expected, str(len(reference.values)), ulp, c_constant(reference.bound)]
    return f"    bad += {call_text('compared', arguments, '    ')};"


def _kernel(subject: Subject, trial: Trial, routine: str) -> list[str]:
    """The lines that call a kernel and compare its results."""
    program = subject.programs[routine]
    results = [r for r in trial.references if r.routine == routine]
    given = {name: f"data_{trial.group(program, name)}" if size else "NULL" for name, size in program.inputs}
    found = {r.name: f"found_{r.name}" for r in results}
    arguments = [*given.values(), *(found.get(name, "NULL") for name, _ in program.outputs)]
    call = call_text(f"{subject.kernel_prefix}_{routine}", arguments, "    ")
    if not results:
        return [f"    {call};"]
    lines = [f"    {subject.real} found_{r.name}[{len(r.values)}];" for r in results]
    lines += [f"    {call};"]
    return lines + [_compared(subject, r, f"found_{r.name}", f"{routine} {r.name}") for r in results]


def _face(subject: Subject, trial: Trial, name: str) -> list[str]:
    """The lines that call a safe function, compare its results, and see it refuse what is not finite."""
    face = next(face for face in faces(subject) if face.name == name)
    P, real = subject.prefix, subject.real
    own = {r.name: r for r in trial.safe[name]}
    results = [own[key] for key in face.outputs if key in own]
    time = ["data_t[0]"] if subject.model.rheonomic else []
    inputs = [f"data_{group}" for group in face.inputs if subject.size(group)]
    outputs = [f"found_{r.name}" for r in results]
    call = call_text(f"{P}_{name}", ["&params", *time, *inputs, *outputs], "    ")
    wrong = call_text(f"{P}_{name}", ["&params", *time, "wrong", *inputs[1:], *outputs], "    ")
    lines = [f"    {P}_params params;", f"    {real} wrong[{subject.macro}_NQ] = {{{c_constant(0.0, real)}}};"]
    lines += [f"    volatile {real} large = {'DBL_MAX' if real == 'double' else 'FLT_MAX'};"]
    lines += [f"    {real} found_{r.name}[{len(r.values)}];" for r in results]
    lines += [f"    {P}_default_params(&params);", "    wrong[0] = large * large;"]
    expected = _status(subject, trial, face.kernels[0])
    lines += [f'    bad += expected_status("{name}", {call}, {P}_{expected});']
    lines += [f'    bad += expected_status("{name} of infinity", {wrong}, {P}_not_finite);']
    if expected != "ok":
        return lines
    return lines + [_compared(subject, r, f"found_{r.name}", f"safe {name} {r.name}") for r in results]


def _status(subject: Subject, trial: Trial, routine: str) -> str:
    """The status that the measures of a routine ask for: what a double bears may be too much for a float."""
    limits = LIMITS[subject.real]
    found = {r.name: float(r.values[0]) for r in trial.references if r.routine == routine and len(r.values) == 1}
    kept = abs(found.get("loss", 0.0)) < limits.loss
    if found["doubt"] >= limits.doubt or found["spread"] >= (limits.spread if kept else limits.large_spread):
        return "singular_coordinates"
    return "ok" if kept else "singular_mass"


def _loops(subject: Subject, trial: Trial) -> list[str]:
    """The lines that see a closed state accepted and, where a nudge opens the loops, that refused and closed again."""
    P, real, model = subject.prefix, subject.real, subject.model
    time = ["data_t[0]"] if model.rheonomic else []
    lines = [f"    {P}_params params;", f"    {real} q[{subject.macro}_NQ];", f"    {P}_default_params(&params);"]

    def status(label: str, call: str, name: str) -> str:
        return f'    bad += expected_status("{label}", {call}, {P}_{name});'

    def state(q: str) -> str:
        return call_text(f"{P}_check_state", ["&params", *time, q], "    ")

    lines += [f"    for (int k = 0; k < {subject.macro}_NQ; k++)", "    {", "        q[k] = data_q[k];", "    }"]
    lines += [status("check_state", state("q"), "ok")]
    moved = [k for k, name in enumerate(model.coordinates) if name in model.dependent]
    if not _opens_and_closes(subject, trial, moved):
        return lines
    nudge = c_constant(_NUDGE, real)
    lines += [f"    q[{k}] += {nudge};" for k in moved]
    lines += [status("check_state of open loops", state("q"), "open_loop")]
    close = call_text(f"{P}_close", ["&params", *time, "q"], "    ")
    return [*lines, status("close", close, "ok"), status("check_state of closed loops", state("q"), "ok")]


def _opens_and_closes(subject: Subject, trial: Trial, moved: list[int]) -> bool:
    """Whether the nudged loops of the model are open, and Newton's method closes them in a regular chart."""
    model, inputs, limits = subject.model, trial.inputs, LIMITS[subject.real]
    t = float(inputs["t"][0]) if model.rheonomic else 0.0
    q = inputs["q"].copy()
    q[moved] += _NUDGE
    if np.abs(model.residual(q, t)).max() < 2 * limits.closed:
        return False
    for _ in range(_STEPS):
        correction, _, spread, doubt = model.evaluate("closing", q, t=t)
        if not (spread < limits.spread and doubt < limits.doubt):
            return False
        q = q + correction
    return bool(np.abs(model.residual(q, t)).max() < CLOSED_STEP)
