"""Where packages are: in the folders that the scenario names."""

from __future__ import annotations

import os

from hrdsl.binding import binding

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from pathlib import Path


class PackageNotFoundError(KeyError):
    """There is no such package."""


def _packages() -> dict[str, str]:
    found = binding().get("packages")
    return found if isinstance(found, dict) else {}


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """The folder of a package's files."""
    if not package_name:
        raise ValueError("Invalid package name, package name can not be empty")
    found = _packages().get(package_name)
    if found is None:
        raise PackageNotFoundError(
            "package '%s' not found, searching: [the packages of the scenario's workspace: %s]"
            % (package_name, ", ".join(sorted(_packages())) or "none")
        )
    return found


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """The same as a `Path`."""
    from pathlib import Path

    return Path(get_package_share_directory(package_name, print_warning))


def get_package_prefix(package_name: str) -> str:
    """What a package is installed below: above `share/NAME`, or its own folder where it is not installed."""
    share = get_package_share_directory(package_name)
    above = os.path.dirname(share)
    if os.path.basename(share) == package_name and os.path.basename(above) == "share":
        return os.path.dirname(above)
    return share


def get_packages_with_prefixes() -> dict[str, str]:
    """All packages, and what they are installed below."""
    return {name: get_package_prefix(name) for name in _packages()}
