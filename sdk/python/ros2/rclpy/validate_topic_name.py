"""Whether the name of a topic or service is valid."""

from rclpy import _names
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """True if it is; raises InvalidTopicNameException, or InvalidServiceNameException, if not."""
    found = _names.fault_of_topic_name(name)
    if found is None:
        return True
    raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *found)
