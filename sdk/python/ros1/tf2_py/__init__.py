"""`BufferCore`: the tree of frames, with the times of rospy."""

from __future__ import annotations

from hrdsl.frames.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)
from hrdsl.frames.tree import FrameTree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]


class BufferCore(FrameTree):
    """Where frames were, for the last ten seconds or for a `rospy.Duration`."""

    def _nanoseconds(self, time: Any) -> int:
        if not hasattr(time, "to_nsec"):
            raise TypeError("time must have a to_sec method, e.g. rospy.Time or rospy.Duration")
        found: int = time.to_nsec()
        return found

    def _time(self, nanoseconds: int) -> Any:
        import rospy

        return rospy.Time(0, nanoseconds)

    _stamp = _time
