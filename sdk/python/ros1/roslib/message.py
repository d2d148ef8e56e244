"""The classes of messages and services by their names."""

from genpy.message import Message, check_type, get_message_class, get_service_class, strify_message

__all__ = ["Message", "check_type", "get_message_class", "get_service_class", "strify_message"]
