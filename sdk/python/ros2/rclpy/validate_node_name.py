"""Whether the name of a node, or its namespace, is valid."""

from rclpy import _names
from rclpy.exceptions import InvalidNodeNameException


def validate_node_name(node_name: str) -> bool:
    """True if it is; raises InvalidNodeNameException if not."""
    found = _names.fault_of_node_name(node_name)
    if found is None:
        return True
    raise InvalidNodeNameException(node_name, *found)
