"""The part of nodes that asks what else there is in the system.

Nodes of other programs are not known by name: of them there are only the topics, services and actions.
"""

from __future__ import annotations

from rclpy import _names, _world
from rclpy._rclpy_pybind11 import NodeNameNonExistentError
from rclpy.validate_full_topic_name import validate_full_topic_name

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

    Typed = list[tuple[str, list[str]]]

#: The nodes of this program.
nodes: list[Any] = []

#: The topics that every node has.
_ALWAYS = (("/parameter_events", "rcl_interfaces/msg/ParameterEvent"), ("/rosout", "rcl_interfaces/msg/Log"))


def _typed(kinds: tuple[str, ...], also: tuple[tuple[str, str], ...] = ()) -> Typed:
    found: dict[str, list[str]] = {}
    pairs = [(port["name"], port["type"]) for port in _world.ports() if port["kind"] in kinds]
    for name, type_name in [*pairs, *also]:
        types = found.setdefault(name, [])
        if type_name not in types:
            types.append(type_name)
    return sorted(found.items())


class NodeGraph:
    """What else there is."""

    def get_name(self) -> str:
        """The node's name."""
        raise NotImplementedError

    def get_namespace(self) -> str:
        """Its namespace."""
        raise NotImplementedError

    def get_topic_names_and_types(self, no_demangle: bool = False) -> Typed:
        """All topics, with the names of their types."""
        return _typed(("publisher", "subscriber"), _ALWAYS)

    def get_service_names_and_types(self) -> Typed:
        """All services, with the names of their types."""
        return _typed(("server",))

    def _full_(self, name: str, is_service: bool) -> str:
        full = _names.expanded(name, self.get_name(), self.get_namespace())
        validate_full_topic_name(full, is_service=is_service)
        return full

    def count_publishers(self, topic_name: str) -> int:
        """How many publishers a topic has."""
        return _world.count("publisher", self._full_(topic_name, False))

    def count_subscribers(self, topic_name: str) -> int:
        """How many subscriptions a topic has."""
        return _world.count("subscriber", self._full_(topic_name, False))

    def count_clients(self, service_name: str) -> int:
        """How many clients a service has."""
        return _world.count("client", self._full_(service_name, True))

    def count_services(self, service_name: str) -> int:
        """How many servers a service has."""
        return _world.count("server", self._full_(service_name, True))

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """The nodes of this program."""
        return [(node.get_name(), node.get_namespace()) for node in nodes]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """The nodes of this program."""
        return [(node.get_name(), node.get_namespace(), "/") for node in nodes]

    def get_node_names(self) -> list[str]:
        """The nodes of this program."""
        return [node.get_name() for node in nodes]

    def get_fully_qualified_node_names(self) -> list[str]:
        """The nodes of this program."""
        return [node.get_fully_qualified_name() for node in nodes]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Looks every tenth of a second whether there is such a node in this program, for so long: whether there is."""
        import time

        end = _world.now() + int(timeout * 1e9)
        name = "/" + fully_qualified_node_name.lstrip("/")
        while name not in self.get_fully_qualified_node_names():
            if _world.now() >= end:
                return False
            time.sleep(0.1)
        return True

    def _of_node_(self, node_name: str, node_namespace: str, kind: str, attribute: str) -> Typed:
        found: dict[str, list[str]] = {}
        for node in nodes:
            if (node.get_name(), node.get_namespace()) == (node_name, "/" + node_namespace.strip("/")):
                for each in getattr(node, attribute):
                    found.setdefault(each._full_name, []).append(each._port.type_name)
                return sorted(found.items())
        text = "Cannot get %s names and types for nonexistent node: node name: %s, node namespace: %s"
        raise NodeNameNonExistentError(text % (kind, node_name, node_namespace))

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> Typed:
        """The topics that a node of this program publishes."""
        return self._of_node_(node_name, node_namespace, "publisher", "_publishers")

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> Typed:
        """The topics that a node of this program has subscribed to."""
        return self._of_node_(node_name, node_namespace, "subscriber", "_subscriptions")

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> Typed:
        """The services of a node of this program."""
        return self._of_node_(node_name, node_namespace, "service", "_services")

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> Typed:
        """The services that a node of this program asks."""
        return self._of_node_(node_name, node_namespace, "client", "_clients")

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[Any]:
        """The publishers of a topic; those of other programs without their profiles."""
        return self._info_("publisher", "_publishers", topic_name)

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[Any]:
        """The subscriptions of a topic; those of other programs without their profiles."""
        return self._info_("subscriber", "_subscriptions", topic_name)

    def _info_(self, kind: str, attribute: str, topic_name: str) -> list[Any]:
        from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum

        full = self._full_(topic_name, False)
        end = TopicEndpointTypeEnum.PUBLISHER if kind == "publisher" else TopicEndpointTypeEnum.SUBSCRIPTION
        known = [(node, each) for node in nodes for each in getattr(node, attribute) if each._full_name == full]
        infos = []
        for port in _world.ports():
            if port["kind"] != kind or port["name"] != full:
                continue
            node, each = known.pop(0) if known else (None, None)
            infos.append(
                TopicEndpointInfo(
                    node_name="_NODE_NAME_UNKNOWN_" if node is None else node.get_name(),
                    node_namespace="_NODE_NAMESPACE_UNKNOWN_" if node is None else node.get_namespace(),
                    topic_type=port["type"],
                    endpoint_type=end,
                    qos_profile=None if each is None else each.qos_profile,
                )
            )
        return infos
