"""Which actions there are."""

from __future__ import annotations

from rclpy import _world
from rclpy._node_graph import nodes

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

    Typed = list[tuple[str, list[str]]]


def get_action_names_and_types(node: Any) -> Typed:
    """All actions, with the names of their types."""
    kinds = ("action_server", "action_client")
    found = {port["name"]: [port["type"]] for port in _world.ports() if port["kind"] in kinds}
    return sorted(found.items())


def _of_node(kind: str, name: str, namespace: str) -> Typed:
    found = {}
    for node in nodes:
        if (node.get_name(), node.get_namespace()) == (name, "/" + namespace.strip("/")):
            for waitable in node._waitables_:
                if waitable._port.kind == kind:
                    found[waitable._port.name] = [waitable._port.type_name]
    return sorted(found.items())


def get_action_client_names_and_types_by_node(node: Any, remote_node_name: str, remote_node_namespace: str) -> Typed:
    """The actions that a node of this program gives goals to."""
    return _of_node("action_client", remote_node_name, remote_node_namespace)


def get_action_server_names_and_types_by_node(node: Any, remote_node_name: str, remote_node_namespace: str) -> Typed:
    """The actions that a node of this program serves."""
    return _of_node("action_server", remote_node_name, remote_node_namespace)
