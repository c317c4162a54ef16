"""The commands together, and how they end: 0, 1 for a bad result, 2 for bad input, 130 for Ctrl-C."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Annotated, cast

import typer

from nullbody import __version__
from nullbody.cli.bench import bench
from nullbody.cli.cache import cache
from nullbody.cli.derive import derive
from nullbody.cli.export_c import c
from nullbody.cli.export_fmu import fmu
from nullbody.cli.inverse import inverse
from nullbody.cli.models import models
from nullbody.cli.output import complain
from nullbody.cli.reproduce import reproduce
from nullbody.cli.simulate import simulate
from nullbody.cli.verify import verify
from nullbody.errors import NullbodyError, SimulationError

__all__ = ["COMMANDS", "EXPORTS", "app", "main"]

COMMANDS = (reproduce, derive, simulate, inverse, verify, bench, models, cache)

#: What follows `nullbody export`.
EXPORTS: dict[str, Callable[..., None]] = {"c": c, "fmu": fmu}

_SETTINGS = {"max_content_width": 100, "help_option_names": ["-h", "--help"]}
_UsageError = cast(type[Exception], typer.BadParameter.__mro__[1])  # typer has moved it from module to module

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,  # rich alone would take as long to import as all the rest of --help
    context_settings=_SETTINGS,
    epilog="\b\nExamples:\n  nullbody models\n  nullbody derive three_prs\n  nullbody reproduce",
)


def _examples(command: object) -> str:
    """The examples of a command, from the constant EXAMPLES of its module, as help that is not wrapped."""
    module = sys.modules[command.__module__]
    return "\n".join(["\b\nExamples:", *(f"  {line}" for line in module.EXAMPLES)])


for _command in COMMANDS:
    app.command(epilog=_examples(_command), context_settings=_SETTINGS)(_command)

export = typer.Typer(
    rich_markup_mode=None,
    context_settings=_SETTINGS,
    help="Write a model as code for other programs; each kind takes --json.",
    epilog="\b\nExamples:\n" + "\n".join(f"  {sys.modules[e.__module__].EXAMPLES[0]}" for e in EXPORTS.values()),
)
for _kind, _export in EXPORTS.items():
    export.command(_kind, epilog=_examples(_export), context_settings=_SETTINGS)(_export)
app.add_typer(export, name="export")


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"nullbody {__version__}")
        raise typer.Exit


@app.callback()
def nullbody(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Smallest equations of motion of closed-loop mechanisms, and what they are good for.

    Every command takes --json, for output that programs read (bench: into a file), and --help, with examples.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command `nullbody`.

    Args:
        arguments: what follows `nullbody` on the command line; by default that of this process.

    Returns:
        The exit code: 0 done; 1 a simulation that ended early, or engines that disagree; 2 bad input, or files
        that cannot be written, with one line on stderr; 130 after Ctrl-C.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        code = typer.main.get_command(app).main(given or ["--help"], prog_name="nullbody", standalone_mode=False)
    except SimulationError as error:
        return complain(error, 1)
    except NullbodyError as error:
        return complain(error, 2)
    except _UsageError as error:
        return complain(_usage(error), 2)
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    if code == 130:
        print("interrupted", file=sys.stderr)
    return code if isinstance(code, int) else 0


def _usage(error: BaseException) -> str:
    """What typer finds wrong with a command line, and where to look."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "nullbody"
    message = str(error.format_message() if hasattr(error, "format_message") else error).rstrip()
    end = "" if message.endswith((".", "?", ")")) else "."
    return f"{message}{end} See {path} --help"
