"""nullbody cache"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Annotated

import typer

from nullbody.cli.options import Json
from nullbody.cli.output import print_json
from nullbody.errors import InputError

if TYPE_CHECKING:
    from nullbody.kernels.cache import CacheInfo

__all__ = ["EXAMPLES", "cache"]

EXAMPLES = ("nullbody cache --info", "nullbody cache --clear", "nullbody cache --info --json")

Info = Annotated[bool, typer.Option("--info", help="Show folder, files, bytes and their bound; the default.")]
Clear = Annotated[bool, typer.Option("--clear", help="Remove all of its files.")]


def cache(info: Info = False, clear: Clear = False, as_json: Json = False) -> None:
    """Show or clear the cache of compiled code.

    NULLBODY_CACHE names its folder (off: none). NULLBODY_CACHE_SIZE bounds it (500MB): what was used least recently
    goes first. Clearing is always safe: code is compiled again when it is needed.
    """
    from dataclasses import asdict

    from nullbody.kernels.cache import cache_info, clear_cache

    if info and clear:
        raise InputError("take one of --info and --clear")
    found = clear_cache() if clear else cache_info()
    if as_json:
        print_json({"cleared": clear, **asdict(found)})
    elif found.folder is None:
        print("the cache is off (NULLBODY_CACHE=off)")
    elif clear:
        print(f"removed {found.files} files, {_size(found.bytes)}, from {found.folder}")
    else:
        _show(found)


def _show(found: CacheInfo) -> None:
    print(f"folder  {found.folder}")
    print(f"files   {found.files}, {_size(found.bytes)} of at most {_size(found.bound)} (NULLBODY_CACHE_SIZE)")
    if found.oldest is not None and found.newest is not None:
        print(f"used    between {_date(found.oldest)} and {_date(found.newest)}")


def _size(count: int) -> str:
    """Bytes in the unit that suits them: 812 B, 3.4 MB."""
    for unit, size in (("GB", 10**9), ("MB", 10**6), ("kB", 10**3)):
        if count >= size:
            return f"{count / size:.3g} {unit}" if count < 999.5 * size else f"{count / size:.0f} {unit}"
    return f"{count} B"


def _date(seconds: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(seconds))
