"""`BufferCore`: the tree of frames, with the times of rclpy."""

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
from rclpy.clock_type import ClockType
from rclpy.time import Time

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
    """Where frames were, for the last ten seconds or for a `Duration`. Times are those of rclpy, or of messages."""

    def _nanoseconds(self, time: Any) -> int:
        if hasattr(time, "sec") and hasattr(time, "nanosec"):
            return int(time.sec) * 10**9 + int(time.nanosec)
        if hasattr(time, "nanoseconds"):
            return int(time.nanoseconds)
        raise TypeError("time must have sec and nanosec, or nanoseconds.")

    def _time(self, nanoseconds: int) -> Time:
        return Time(nanoseconds=nanoseconds, clock_type=ClockType.ROS_TIME)

    def _stamp(self, nanoseconds: int) -> Any:
        return self._time(nanoseconds).to_msg()
