"""Names of the ROS graph: what is legal, and what they are within a namespace."""

from __future__ import annotations

import os
import re
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MSG_EXT = ".msg"
SRV_EXT = ".srv"
SEP = "/"
GLOBALNS = "/"
PRIV_NAME = "~"
REMAP = ":="
ANYTYPE = "*"
ROS_NAMESPACE = "ROS_NAMESPACE"

NAME_LEGAL_CHARS_P = re.compile(r"^[\~\/A-Za-z][\w\/]*$")
BASE_NAME_LEGAL_CHARS_P = re.compile(r"^[A-Za-z][\w]*$")
REMAP_PATTERN = re.compile(r"^([\~\/A-Za-z]|_|__)[\w\/]*" + REMAP + ".*")


def _matches(pattern: re.Pattern[str], text: str | None) -> bool:
    found = None if text is None else pattern.match(text)
    return found is not None and found.group(0) == text


def is_legal_name(name: str | None) -> bool:
    """Whether a topic, service, node or parameter may be called so."""
    return name == "" or _matches(NAME_LEGAL_CHARS_P, name) and "//" not in str(name)


def is_legal_base_name(name: str | None) -> bool:
    """Whether it is a name without a namespace."""
    return _matches(BASE_NAME_LEGAL_CHARS_P, name)


def is_legal_remap(arg: str | None) -> bool:
    """Whether it is an argument of the form `from:=to`."""
    return _matches(REMAP_PATTERN, arg)


def is_global(name: str) -> Any:
    return name and name[0] == SEP


def is_private(name: str) -> Any:
    return name and name[0] == PRIV_NAME


def get_ros_namespace(env: Any = None, argv: list[str] | None = None) -> str:
    """The namespace of this process, from its arguments or its environment."""
    for arg in sys.argv if argv is None else argv:
        if arg.startswith("__ns:="):
            return make_global_ns(arg[len("__ns:=") :])
    return make_global_ns((os.environ if env is None else env).get(ROS_NAMESPACE, GLOBALNS))


def make_global_ns(name: str) -> str:
    """With a slash before and behind it."""
    if is_private(name):
        raise ValueError("cannot turn [%s] into a global name" % name)
    if not is_global(name):
        name = SEP + name
    return name if name[-1] == SEP else name + SEP


def make_caller_id(name: str) -> str:
    return make_global_ns(ns_join(get_ros_namespace(), name))


def namespace(name: str) -> str:
    """That in which the name lies, with a slash behind it."""
    if name is None:
        raise ValueError("name")
    if not isinstance(name, str):
        raise TypeError("name")
    if name.endswith(SEP):
        name = name[:-1]
    return name[: name.rfind(SEP) + 1] or SEP


def ns_join(ns: str, name: str) -> str:
    """A name within a namespace; names that are global or private stay as they are."""
    if is_private(name) or is_global(name):
        return name
    if ns == PRIV_NAME:
        return PRIV_NAME + name
    if not ns:
        return name
    return ns + name if ns[-1] == SEP else ns + SEP + name


def load_mappings(argv: list[str]) -> dict[str, str]:
    """The remappings among the arguments, without those that set parameters."""
    mappings = {}
    for arg in argv:
        if is_legal_remap(arg):
            parts = [part.strip() for part in arg.split(REMAP)]
            if len(parts) != 2:
                sys.stderr.write("ERROR: Invalid remapping argument '%s'\n" % arg)
            elif all(parts) and not (len(parts[0]) > 1 and parts[0][0] == "_" and parts[0][1] != "_"):
                mappings[parts[0]] = parts[1]
    return mappings


def canonicalize_name(name: str) -> str:
    """Without slashes that say nothing."""
    if not name or name == SEP:
        return name
    return (SEP if name[0] == SEP else "") + SEP.join(part for part in name.split(SEP) if part)


def resolve_name(name: str, namespace_: str, remappings: Any = None) -> str:
    """The global name of a name that is used by a node."""
    if not name:
        return namespace(namespace_)
    name = canonicalize_name(name)
    if is_global(name):
        resolved = name
    elif is_private(name):
        resolved = canonicalize_name(namespace_ + SEP + name[1:])
    else:
        resolved = namespace(namespace_) + name
    return remappings[resolved] if remappings and resolved in remappings else resolved


def script_resolve_name(script_name: str, name: str) -> str:
    """As `resolve_name`, for a script that is no node."""
    if not name:
        return get_ros_namespace()
    if is_global(name):
        return name
    if is_private(name):
        return ns_join(make_caller_id(script_name), name[1:])
    return get_ros_namespace() + name


def anonymous_name(id: str) -> str:
    """One that no other node has."""
    import random
    import time

    return "%s_%s_%s_%s" % (id, os.uname().nodename.replace("-", "_").replace(".", "_"), os.getpid(), int(time.time() * 1000) + random.randint(0, 999))
