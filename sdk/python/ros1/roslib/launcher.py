"""Where programs of the time before catkin find their modules."""

from __future__ import annotations


def load_manifest(package_name: str, bootstrap_version: str = "0.7") -> None:
    """Nothing: what the program needs is found already."""
