"""The node's name, and what other names are for it."""

from __future__ import annotations

import sys

from rosgraph import names as graph
from rosgraph.names import (
    ANYTYPE,
    GLOBALNS,
    PRIV_NAME,
    REMAP,
    SEP,
    canonicalize_name,
    get_ros_namespace,
    is_global,
    is_legal_name,
    is_private,
    load_mappings,
    namespace,
    ns_join,
)
from rospy.exceptions import ROSException, ROSInitException

__all__ = [
    "ANYTYPE", "GLOBALNS", "PRIV_NAME", "REMAP", "SEP", "canonicalize_name", "get_caller_id", "get_mappings", "get_name",
    "get_namespace", "get_resolved_mappings", "get_ros_namespace", "initialize_mappings", "is_global", "is_legal_name",
    "is_private", "load_mappings", "namespace", "ns_join", "reload_mappings", "remap_name", "resolve_name",
    "resolve_name_without_node_name", "scoped_name",
]  # fmt: skip

TOPIC_ANYTYPE = ANYTYPE
SERVICE_ANYTYPE = ANYTYPE

_mappings = load_mappings(sys.argv)
_resolved_mappings: dict[str, str] = {}
_caller_namespace = get_ros_namespace()
_caller_id = _caller_namespace + "unnamed"


def get_namespace() -> str:
    """That of the node, with a slash behind it."""
    return _caller_namespace


def get_name() -> str:
    """The node's name with its namespace."""
    return _caller_id


get_caller_id = get_name


def _set_caller_id(caller_id: str) -> None:
    global _caller_id, _caller_namespace
    _caller_id, _caller_namespace = caller_id, namespace(caller_id)


def get_mappings() -> dict[str, str]:
    """The remappings as they were given."""
    return _mappings


def get_resolved_mappings() -> dict[str, str]:
    """The remappings with global names."""
    return _resolved_mappings


def reload_mappings(argv: list[str]) -> None:
    """Takes the remappings from other arguments."""
    global _mappings
    _mappings = load_mappings(argv)


def initialize_mappings(node_name: str) -> None:
    """Resolves the remappings, now that the node has its name."""
    global _resolved_mappings
    _resolved_mappings = {}
    for old, new in _mappings.items():
        if old.startswith("__"):
            _resolved_mappings[old] = new
        else:
            _resolved_mappings[graph.resolve_name(old, node_name)] = graph.resolve_name(new, node_name)


def resolve_name(name: str, caller_id: str | None = None) -> str:
    """The global name of a name that the node uses."""
    caller_id = caller_id or _caller_id
    if not name:
        return namespace(caller_id)
    name = canonicalize_name(str(name))
    if name[0] == SEP:
        resolved = name
    elif name[0] == PRIV_NAME:
        resolved = ns_join(caller_id, name[1:])
    else:
        resolved = namespace(caller_id) + name
    return _resolved_mappings.get(resolved, resolved)


def resolve_name_without_node_name(name: str) -> str:
    """As `resolve_name`, before the node has its name."""
    if is_private(name):
        raise ValueError("~name topics cannot be created before init_node() has been called")
    stand_in = ns_join(_caller_namespace, "node")
    resolved = graph.resolve_name(name, stand_in)
    for old, new in _mappings.items():
        if graph.resolve_name(old, stand_in) == resolved:
            if is_private(new):
                raise ROSInitException(
                    "due to the way this node is written, %s cannot be remapped to a ~name. \nThe declaration of topics/services"
                    " must be moved after the call to init_node()" % name
                )
            return graph.resolve_name(new, stand_in)
    return resolved


def remap_name(name: str, caller_id: str | None = None, resolved: bool = True) -> str:
    """The name that is used for it, if it is remapped."""
    if name in _mappings:
        return graph.resolve_name(_mappings[name], caller_id or _caller_id)
    return name


def scoped_name(caller_id: str, name: str) -> str:
    """The name within the namespace of a node."""
    if not is_global(caller_id):
        raise ROSException("caller_id must be global")
    return canonicalize_name(name)[len(namespace(caller_id)) :]
