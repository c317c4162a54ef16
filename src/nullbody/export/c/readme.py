"""The build file and the page that go with a model in C."""

from __future__ import annotations

from string import Template

from nullbody.export.c.face import faces
from nullbody.export.c.limits import LIMITS
from nullbody.export.c.subject import Subject
from nullbody.export.c.text import title

__all__ = ["build_file", "readme"]

_CMAKE = Template(
    """cmake_minimum_required(VERSION 3.10)
project($P C)

add_library($P STATIC $P.c)
target_include_directories($P PUBLIC $${CMAKE_CURRENT_SOURCE_DIR})
set_target_properties($P PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
if(UNIX)
  target_link_libraries($P PUBLIC m)
endif()

enable_testing()
add_executable(${P}_test ${P}_test.c)
target_link_libraries(${P}_test PRIVATE $P)
set_target_properties(${P}_test PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
add_test(NAME ${P}_test COMMAND ${P}_test)
"""
)

_README = Template(
    """# $TITLE

`$P.h` says what everything means: the order of q, v and u with units, parameters, statuses, functions.
The code is C99: no allocation, no globals, no recursion, of libm only sin, cos and sqrt.

    cc -std=c99 -O2 -c $P.c
    cc -std=c99 -O2 ${P}_test.c $P.o -lm -o ${P}_test && ./${P}_test

or `cmake -B build && cmake --build build && ctest --test-dir build`. The test program compares every function with
stored numbers of nullbody's own kernels, prints the distances, and ends with 1 where one is too large.
Do not compile with -ffast-math: the checks need NaN and infinity.

```c
${P}_params params;
${P}_default_params(&params);
$EXAMPLE
```

| function | finds |
|---|---|
$ROWS

Each returns `${P}_ok` (0) or what is wrong, and then leaves its outputs as they were:
results whose null space has |N|^2 above $SPREAD, or whose Mr cancels by more than $LOSS, have lost too many digits of
a $R and are refused, never returned. `${P}_message` gives the text.
$LOOPS
The kernels `${P}_kernel_*` are the same equations without checks.
"""
)


_LOOPS = Template("They trust that the loops are closed at q: `${P}_check_state` says so, `${P}_close` closes them.")


def build_file(subject: Subject) -> str:
    """CMakeLists.txt."""
    return _CMAKE.substitute(P=subject.prefix)


def readme(subject: Subject) -> str:
    """README.md."""
    P, limits = subject.prefix, LIMITS[subject.real]
    rows = [f"| `{P}_{face.name}` | {face.meaning.replace('|', ' ')} |" for face in faces(subject)]
    if subject.model.closure_labels:
        rows += [f"| `{P}_check_state` | whether the loops are closed at q |"]
        rows += [f"| `{P}_close` | q with closed loops, the independent coordinates held |"]
    time = "t, " if subject.model.rheonomic else ""
    inputs = "u, " if subject.model.inputs else ""
    example = f"if ({P}_forward_dynamics(&params, {time}q, v, {inputs}q_ddot) != {P}_ok)\n{{\n    stop();\n}}"
    return _README.substitute(
        TITLE=title(subject),
        P=P,
        R=subject.real,
        EXAMPLE=example,
        ROWS="\n".join(rows),
        LOOPS=_LOOPS.substitute(P=P) if subject.model.closure_labels else "There are no loops that could be open.",
        SPREAD=f"{limits.spread:.1e}",
        LOSS=f"{limits.loss:.1e}",
    )
