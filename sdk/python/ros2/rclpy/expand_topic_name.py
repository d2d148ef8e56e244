"""Full names of topics and services."""

from rclpy import _names


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """The full name of a topic as a node writes it; raises ValueError if one of the names is invalid."""
    return _names.expanded(topic_name, node_name, node_namespace)
