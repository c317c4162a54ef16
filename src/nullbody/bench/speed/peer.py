"""Why a peer has no figure."""

from __future__ import annotations

__all__ = ["Missing", "Stopped"]


class Missing(Exception):
    """The peer is not installed, or too old; the message says how to install it."""


class Stopped(Exception):
    """The peer took longer than its patience, or it cannot do this work; the message says which."""
