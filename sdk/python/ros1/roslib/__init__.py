"""What old programs load before all else."""

from __future__ import annotations

import roslib.message
import roslib.names
import roslib.packages


def load_manifest(package_name: str) -> None:
    """Nothing: what the program needs is found already."""


def is_interactive() -> bool:
    return False


def set_interactive(interactive: bool) -> None:
    """Nothing."""
