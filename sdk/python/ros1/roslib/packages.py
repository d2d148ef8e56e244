"""Where packages are."""

from __future__ import annotations

import rospkg


class ROSPkgException(Exception):
    """What is wrong with packages."""


class InvalidROSPkgException(ROSPkgException):
    """There is no such package."""


def get_pkg_dir(package: str, required: bool = True, ros_root: object = None, ros_package_path: object = None) -> str | None:
    """The folder of a package."""
    try:
        return rospkg.RosPack().get_path(package)
    except rospkg.ResourceNotFound:
        if required:
            raise InvalidROSPkgException("Cannot locate installation of package %s" % package) from None
        return None


def get_dir_pkg(d: str) -> tuple[str | None, str | None]:
    """The package in which a folder lies: its folder, and its name."""
    name = rospkg.get_package_name(d)
    return (None, None) if name is None else (get_pkg_dir(name, required=False) or d, name)
