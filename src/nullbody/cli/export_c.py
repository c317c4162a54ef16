"""nullbody export c"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nullbody.cli.options import Independent, Json, MechanismName, Parameters, model_of
from nullbody.cli.output import note, print_json, print_table

__all__ = ["EXAMPLES", "c"]

EXAMPLES = (
    "nullbody export c three_prs -o controller",
    "nullbody export c four_bar -o four_bar_c --real float --prefix fb --set crank=2.2",
    "nullbody export c three_prs -o controller --real float --size --json",
)

Folder = Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="Where the files go; made if need be.")]
Number = Annotated[str, typer.Option("--real", metavar="TYPE", help="Type of all numbers: double or float.")]
Prefix = Annotated[
    str | None, typer.Option(metavar="NAME", help="What every name in C begins with; the mechanism's by default.")
]
Size = Annotated[bool, typer.Option("--size", help="Compile for an Arm Cortex-M7 and print the size; needs ziglang.")]


def c(
    mechanism: MechanismName,
    out: Folder,
    real: Number = "double",
    prefix: Prefix = None,
    parameters: Parameters = None,
    independent: Independent = None,
    size: Size = False,
    as_json: Json = False,
) -> None:
    """Write a model as C99 for a controller: a header, a source file, a test program, CMakeLists.txt, README.md.

    The code allocates nothing and has no globals. Its functions check what goes in and comes out, and return a status.
    """
    from nullbody.export.c import cortex_m7_size, write_c
    from nullbody.kernels.c99 import checked_real

    written = write_c(model_of(mechanism, independent, parameters), out, real=checked_real(real), prefix=prefix)
    sizes = cortex_m7_size(written) if size else None
    if as_json:
        sized = None if sizes is None else sizes._asdict()
        print_json({"folder": written.folder, "prefix": written.prefix, "files": written.files, "cortex_m7": sized})
        return
    rows = [(path.name, path.stat().st_size) for path in written.files]
    print_table(("file", "bytes"), rows)
    if sizes is not None:
        rows = [("code and constants", sizes.flash), ("data", sizes.ram), *sizes.functions.items()]
        print_table(("Cortex-M7 object", "bytes"), rows)
    note(f"written to {written.folder}; the test program is {written.test.name}")
