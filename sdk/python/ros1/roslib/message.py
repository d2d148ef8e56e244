"""The classes of messages and services by their names, and what was here before it was in `genpy`."""

from genpy import DeserializationError, Duration, Message, SerializationError, Time, TVal
from genpy.message import check_type, fill_message_args, get_message_class, get_service_class, strify_message

__all__ = [
    "DeserializationError", "Duration", "Message", "SerializationError", "TVal", "Time", "check_type",
    "fill_message_args", "get_message_class", "get_service_class", "strify_message",
]  # fmt: skip
