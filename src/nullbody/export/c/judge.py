"""What the safe functions in C share: statuses, checks of numbers and of results, closing and checking of states."""

from __future__ import annotations

from math import prod
from string import Template

from nullbody.export.c.limits import LIMITS
from nullbody.export.c.subject import Subject
from nullbody.kernels.c99 import c_constant
from nullbody.tolerances import NEWTON_STEPS

__all__ = ["STATUSES", "judges", "limits", "loops", "loops_prototypes"]

#: (name, message) of every status, from 0.
STATUSES = (
    ("ok", "done"),
    ("not_finite", "an input, a parameter or a result is no finite number"),
    ("singular_coordinates", "the independent coordinates are singular here: results would lose too many digits"),
    ("singular_mass", "the reduced mass matrix is singular here: a motion moves no mass, or next to none"),
    ("singular_inputs", "the inputs cannot drive all degrees of freedom here"),
    ("open_loop", "a loop is open, or closed the wrong way round"),
)

_JUDGES = Template(
    """static int ${P}_finite(const $R *x, int n)
{
    int good = 1;
    for (int k = 0; k < n; k++)
    {
        if (!((x[k] <= $LARGEST) && (x[k] >= -$LARGEST)))
        {
            good = 0;
        }
    }
    return good;
}

static void ${P}_copied(const $R *from, int n, $R *to)
{
    for (int k = 0; k < n; k++)
    {
        to[k] = from[k];
    }
}

/* N has lost too many digits; NaN fails every comparison */
static ${P}_status ${P}_judged_space($R spread, $R doubt, $R limit)
{
    return ((spread < limit) && (doubt < ${M}_DOUBT)) ? ${P}_ok : ${P}_singular_coordinates;
}

static ${P}_status ${P}_judged_dynamics($R spread, $R doubt, $R loss, int finite)
{
    const int kept = ((loss < ${M}_LOSS) && (loss > -${M}_LOSS)) ? 1 : 0;
    const $R limit = ((kept != 0) && (finite != 0)) ? ${M}_SPREAD : ${M}_LARGE_SPREAD;
    ${P}_status status = ${P}_judged_space(spread, doubt, limit);
    if ((status == ${P}_ok) && (kept == 0))
    {
        status = ${P}_singular_mass;
    }
    if ((status == ${P}_ok) && (finite == 0))
    {
        status = ${P}_not_finite;
    }
    return status;
}

const char *${P}_message(${P}_status status)
{
    static const char *const messages[] = {
$MESSAGES
    };
    return (((int)status >= 0) && ((int)status < $COUNT)) ? messages[status] : "no such status";
}
"""
)

_REGULAR = Template(
    """
/* Br is regular: elimination with complete pivoting leaves no pivot that is small against the largest, or 1 */
static int ${P}_regular(const $R *Br)
{
    $R a[$NV][$NV];
    $R largest = $ONE;
    int good = 1;
    for (int i = 0; i < $NV; i++)
    {
        ${P}_copied(&Br[$NV * i], $NV, a[i]);
    }
    for (int k = 0; k < $NV; k++)
    {
        $R pivot = $ZERO;
        int row = k;
        int column = k;
        for (int i = k; i < $NV; i++)
        {
            for (int j = k; j < $NV; j++)
            {
                const $R size = (a[i][j] < $ZERO) ? -a[i][j] : a[i][j];
                if (size > pivot)
                {
                    pivot = size;
                    row = i;
                    column = j;
                }
            }
        }
        largest = (pivot > largest) ? pivot : largest;
        if (!(pivot > (${M}_RANK * largest)))
        {
            good = 0;
            break;
        }
        for (int j = 0; j < $NV; j++)
        {
            const $R kept = a[k][j];
            a[k][j] = a[row][j];
            a[row][j] = kept;
        }
        for (int i = 0; i < $NV; i++)
        {
            const $R kept = a[i][k];
            a[i][k] = a[i][column];
            a[i][column] = kept;
        }
        for (int i = k + 1; i < $NV; i++)
        {
            const $R factor = a[i][k] / a[k][k];
            for (int j = k; j < $NV; j++)
            {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    return good;
}
"""
)

_LOOPS = Template(
    """
$CHECK_HEAD
{
    $R p[${M}_NP];
$CHECK_ARRAYS
    ${P}_status status = ${P}_not_finite;

    ${P}_packed(params, p);
    if ($FINITE)
    {
$CHECK_CALLS
        status = (${P}_small(found_Phi, $NPHI) != 0) ? ${P}_ok : ${P}_open_loop;$CHECK_MORE
    }
    return status;
}

$CLOSE_HEAD
{
    $R p[${M}_NP];
    $R moved[${M}_NQ];
$CLOSE_ARRAYS
    ${P}_status status = ${P}_not_finite;

    ${P}_packed(params, p);
    ${P}_copied(q, ${M}_NQ, moved);
    if ($FINITE)
    {
        int steps = 0;
        $R largest = $ONE;
        status = ${P}_ok;
        while ((status == ${P}_ok) && (steps < ${M}_NEWTON_STEPS) && (largest > ${M}_STEP))
        {
            $CLOSE_CALL
            status = ${P}_judged_space(found_spread[0], found_doubt[0], ${M}_SPREAD);
            largest = $ZERO;
            for (int k = 0; k < ${M}_NQ; k++)
            {
                const $R size = (found_correction[k] < $ZERO) ? -found_correction[k] : found_correction[k];
                largest = (size > largest) ? size : largest;
                moved[k] += found_correction[k];
            }
            steps++;
        }
        if (status == ${P}_ok)
        {
            status = ${P}_check_state(params, ${T}moved);
        }
    }
    if (status == ${P}_ok)
    {
        ${P}_copied(moved, ${M}_NQ, q);
    }
    return status;
}
"""
)

_SMALL = Template(
    """
static int ${P}_small(const $R *Phi, int n)
{
    int good = 1;
    for (int k = 0; k < n; k++)
    {
        if (!((Phi[k] <= ${M}_CLOSED) && (Phi[k] >= -${M}_CLOSED)))
        {
            good = 0;
        }
    }
    return good;
}
"""
)


def limits(subject: Subject) -> str:
    """The tolerances as macros of the source file."""
    found = LIMITS[subject.real]
    lines = [
        f"#define {subject.macro}_{name.upper()} {c_constant(value, subject.real)} /* {note} */"
        for name, value, note in (
            ("closed", found.closed, "|Phi| of a closed state [m]"),
            ("spread", found.spread, "|N|^2 of a good result"),
            ("large_spread", found.large_spread, "|N|^2 from which a bad result is put down to the coordinates"),
            ("doubt", found.doubt, "(|B| / product of its column lengths)^-2 of a good result"),
            ("loss", found.loss, "what may cancel in N^T M N"),
            ("rank", found.rank, "smallest pivot of Br against the largest, or 1"),
            ("step", found.step, "a Newton step after which only rounding is left [m, rad]"),
        )
    ]
    return "\n".join([*lines, f"#define {subject.macro}_NEWTON_STEPS {NEWTON_STEPS}", ""])


def judges(subject: Subject, regular: bool) -> str:
    """The checks of numbers and of results; with `regular` that of Br too."""
    messages = ",\n".join(f'        "{text}"' for _, text in STATUSES)
    names = {**_names(subject), "MESSAGES": messages, "COUNT": len(STATUSES), "NV": len(subject.model.independent)}
    names["LARGEST"] = "DBL_MAX" if subject.real == "double" else "FLT_MAX"
    return _JUDGES.substitute(names) + (_REGULAR.substitute(names) if regular else "")


def loops_prototypes(subject: Subject) -> tuple[str, str]:
    """The heads of the functions that check and that close the loops."""
    check = subject.head("check_state", ("q",), ())
    return check, subject.head("close", (), (f"{subject.real} *q",))


def loops(subject: Subject) -> str:
    """The functions that check and that close the loops."""
    check, close = loops_prototypes(subject)
    sizes = {name: prod(subject.programs[name].outputs[0][1]) for name in ("residual", "redundant", "facing")}
    found = {"Phi": sizes["residual"]}
    calls, more = [subject.call("residual", ("q",))], []
    names = _names(subject)
    P, bad = subject.prefix, "        status = (({test}) && (status == {P}_ok)) ? {P}_ok : {P}_open_loop;"
    if sizes["redundant"]:
        found["redundant"] = sizes["redundant"]
        calls.append(subject.call("redundant", ("q",)).replace("found_Phi", "found_redundant"))
        more.append(bad.format(P=P, test=f"{P}_small(found_redundant, {sizes['redundant']}) != 0"))
    if sizes["facing"]:
        found["cosines"] = sizes["facing"]
        calls.append(subject.call("facing", ("q",)))
        test = " && ".join(f"(found_cosines[{k}] > {names['ZERO']})" for k in range(sizes["facing"]))
        more.append(bad.format(P=P, test=test))
    closing = {key: prod(shape) for key, shape in subject.programs["closing"].outputs}
    names |= {
        "CHECK_HEAD": check,
        "CLOSE_HEAD": close,
        "CHECK_ARRAYS": "\n".join(f"    {line}" for line in subject.arrays(found)),
        "CLOSE_ARRAYS": "\n".join(f"    {line}" for line in subject.arrays(closing)),
        "CHECK_CALLS": "\n".join(f"        {line}" for line in calls),
        "CHECK_MORE": "".join(f"\n{line}" for line in more),
        "CLOSE_CALL": subject.call("closing", ("q",)).replace("(q,", "(moved,"),
        "FINITE": subject.finite(("q",)),
        "NPHI": sizes["residual"],
        "T": "t, " if subject.model.rheonomic else "",
    }
    return _SMALL.substitute(names) + _LOOPS.substitute(names)


def _names(subject: Subject) -> dict[str, object]:
    one, zero = (c_constant(value, subject.real) for value in (1.0, 0.0))
    return {"P": subject.prefix, "M": subject.macro, "R": subject.real, "ONE": one, "ZERO": zero}
