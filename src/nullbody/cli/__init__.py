"""Layer 11: the command `nullbody`."""

from nullbody.cli.app import main

__all__ = ["main"]
