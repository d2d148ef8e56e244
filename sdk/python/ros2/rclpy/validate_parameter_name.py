"""Whether the name of a parameter is valid."""

from rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """True if it is; raises InvalidParameterException if not."""
    if not name:
        raise InvalidParameterException(name)
    return True
