"""Whether the name of a node, or its namespace, is valid."""

from rclpy import _names
from rclpy.exceptions import InvalidNamespaceException


def validate_namespace(namespace: str) -> bool:
    """True if it is; raises InvalidNamespaceException if not."""
    found = _names.fault_of_namespace(namespace)
    if found is None:
        return True
    raise InvalidNamespaceException(namespace, *found)
