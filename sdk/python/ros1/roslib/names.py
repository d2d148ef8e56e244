"""As `rosgraph.names`, and the names of resources: types of messages in their packages."""

from __future__ import annotations

import re

import rosgraph.names
from rosgraph.names import *  # noqa: F403
from rosgraph.names import BASE_NAME_LEGAL_CHARS_P, is_legal_base_name

PRN_SEPARATOR = "/"
TYPE_SEPARATOR = PRN_SEPARATOR
RESOURCE_NAME_LEGAL_CHARS_P = re.compile(r"^[A-Za-z][\w\/]*$")
BASE_RESOURCE_NAME_LEGAL_CHARS_P = BASE_NAME_LEGAL_CHARS_P


def resource_name(res_pkg_name: str, name: str, my_pkg: str | None = None) -> str:
    """The name of a resource of a package, as it is said in that package or in another one."""
    return name if res_pkg_name == my_pkg else res_pkg_name + PRN_SEPARATOR + name


def resource_name_base(name: str) -> str:
    """Without the package."""
    return name.rpartition(PRN_SEPARATOR)[2]


def resource_name_package(name: str) -> str | None:
    """The package, if it is named."""
    return name.partition(PRN_SEPARATOR)[0] if PRN_SEPARATOR in name else None


def package_resource_name(name: str) -> tuple[str, str]:
    """The package, which may be empty, and the name in it."""
    parts = name.split(PRN_SEPARATOR)
    if len(parts) > 2:
        raise ValueError("invalid name [%s]" % name)
    return ("", name) if len(parts) == 1 else (parts[0], parts[1])


def is_legal_resource_name(name: str | None) -> bool:
    """Whether a resource may be called so, with or without a package."""
    return rosgraph.names._matches(RESOURCE_NAME_LEGAL_CHARS_P, name) and "//" not in str(name)


def is_legal_resource_base_name(name: str | None) -> bool:
    """Whether it is such a name without a package."""
    return is_legal_base_name(name)
