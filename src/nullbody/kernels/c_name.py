"""Names that C takes: letters, digits and _, no keyword, none twice."""

from __future__ import annotations

import re
from collections.abc import Iterable

from nullbody.errors import InputError

__all__ = ["check_prefix", "identifiers"]

#: Keywords of C99, C11 and C++, macros of <math.h> (those of POSIX too) and <stdio.h>, and the functions that the
#: printed code calls.
_RESERVED = frozenset(
    re.findall(
        r"\w+",
        """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    alignas alignof and and_eq asm bitand bitor bool catch char16_t char32_t class compl concept const_cast constexpr
    decltype delete dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr
    operator or or_eq private protected public reinterpret_cast requires static_assert static_cast template this
    thread_local throw true try typeid typename typeof using virtual wchar_t xor xor_eq
    DOMAIN HUGE HUGE_VAL HUGE_VALF HUGE_VALL INFINITY MATH_ERREXCEPT MATH_ERRNO MAXFLOAT NAN NULL OVERFLOW PLOSS SING
    TLOSS UNDERFLOW X_TLOSS errno fpclassify isfinite isgreater isgreaterequal isinf isless islessequal islessgreater
    isnan isnormal isunordered main math_errhandling signbit unix linux sin cos sqrt sinf cosf sqrtf
    M_1_PI M_2_PI M_2_SQRTPI M_E M_LN10 M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_4 M_SQRT1_2 M_SQRT2
    BUFSIZ EOF FILENAME_MAX FOPEN_MAX L_tmpnam P_tmpdir SEEK_CUR SEEK_END SEEK_SET TMP_MAX stderr stdin stdout
    """,
    )
)

#: Macros of <float.h> and <math.h> are many, and grow.
_MACRO = re.compile(r"(FLT|DBL|LDBL|FP|DECIMAL)_[A-Z0-9_]+")


def identifiers(names: Iterable[str], taken: Iterable[str] = ()) -> list[str]:
    """Names as C identifiers, in order and all different.

    What is neither letter (a to z) nor digit becomes _, a leading digit gets n_ in front; a name that C or another
    name has taken gets _ behind; what looks like a macro of <float.h> gets _n.

    Args:
        names: any texts.
        taken: identifiers that none may have.
    """
    used, made = {*_RESERVED, *taken}, []
    for name in names:
        text = re.sub(r"[^A-Za-z0-9_]", "_", name).lstrip("_") or "n"
        text = f"n_{text}" if text[0].isdigit() else text
        text += "_n" if _MACRO.fullmatch(text) else ""
        while text in used:
            text += "_"
        used.add(text)
        made.append(text)
    return made


def check_prefix(prefix: str) -> None:
    """Raise unless names of C functions can begin with this text.

    Raises:
        InputError: it is no text, no identifier, begins with _ (such names belong to the compiler), or is a word of C.
    """
    if not isinstance(prefix, str):
        raise InputError(f"names in C begin with a text, not with {prefix!r}")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", prefix) or prefix in _RESERVED:
        raise InputError(
            f"names in C cannot begin with {prefix!r}: use a letter, then letters, digits and _, such as "
            f"{identifiers([prefix])[0]!r}"
        )
