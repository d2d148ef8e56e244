"""Messages and times as ROS 1's `genpy` has them. The classes of messages are made by `genpy.factory`, from definitions."""

from genpy.message import (
    DeserializationError,
    Message,
    MessageException,
    SerializationError,
    struct_I,
)
from genpy.rostime import Duration, Time, TVal

__all__ = [
    "DeserializationError", "Duration", "Message", "MessageException", "SerializationError", "TVal", "Time", "struct_I",
]  # fmt: skip
