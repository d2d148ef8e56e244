"""What old programs load before all else."""

from __future__ import annotations

from roslib import message, names, packages
from roslib.launcher import load_manifest

__version__ = "1.7.0"
__all__ = ["is_interactive", "load_manifest", "message", "names", "packages", "set_interactive"]

_is_interactive = False


def set_interactive(interactive: bool) -> None:
    """Keeps what it is told."""
    global _is_interactive
    _is_interactive = interactive


def is_interactive() -> bool:
    """What `set_interactive` was told."""
    return _is_interactive
