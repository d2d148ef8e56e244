"""How messages of a type are brought into another frame."""

from __future__ import annotations

import rospy
from hrdsl.frames.conversion import (
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NONE = rospy.Duration(0.0)


class BufferInterface:
    """Brings stamped messages into other frames."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(self, object_stamped: Any, target_frame: str, timeout: Any = _NONE, new_type: Any = None) -> Any:
        """The message as seen from another frame, perhaps converted."""
        change = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = change(object_stamped, self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout))
        return convert(found, new_type) if new_type else found

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = _NONE,
        new_type: Any = None,
    ) -> Any:
        """The same, as seen from there at another time."""
        change = self.registration.get(type(object_stamped))
        header = object_stamped.header
        place = self.lookup_transform_full(target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout)
        found = change(object_stamped, place)
        return convert(found, new_type) if new_type else found

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = _NONE) -> Any:
        """A buffer has its own."""
        raise NotImplementedException()

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = _NONE,
    ) -> Any:
        """A buffer has its own."""
        raise NotImplementedException()
