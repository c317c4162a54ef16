"""What ran: the machine and the versions of packages."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path

from nullbody import __version__

__all__ = ["facts", "machine", "processor", "versions"]


def versions(packages: Iterable[str]) -> Mapping[str, str | None]:
    """Versions of packages; nothing for those that are not installed."""
    from importlib.metadata import PackageNotFoundError, version

    found: dict[str, str | None] = {}
    for name in packages:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = None
    return found


def facts(seconds: float, packages: Iterable[str]) -> dict[str, str]:
    """What a page says about a run of that many seconds."""
    found = ", ".join(f"{name} {version}" for name, version in versions(packages).items() if version)
    return {
        "made": time.strftime("%Y-%m-%d %H:%M %Z"),
        "run time": f"{seconds:.1f} s",
        "machine": machine(),
        "versions": f"nullbody {__version__}, Python {platform.python_version()}, {found}",
    }


def machine() -> str:
    """Processor, cores and system in a line."""
    return f"{processor()}, {os.cpu_count()} logical cores, {platform.system()}"


def processor() -> str:
    """The processor's name, as far as the system tells it."""
    if sys.platform == "linux":
        try:
            lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        except OSError:
            lines = []
        for line in lines:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
