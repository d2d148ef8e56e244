"""ROS 1's filters of messages: caches, and messages of several topics that belong together by their stamps."""

from __future__ import annotations

import genpy
import rospy
from hrdsl.filters import Approximated, Cached, SimpleFilter, Synchronized

__all__ = ["ApproximateTimeSynchronizer", "Cache", "SimpleFilter", "Subscriber", "TimeSynchronizer"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _OfRospy:
    """How rospy tells times and warns."""

    def nanoseconds(self, stamp: Any) -> int:
        return int(stamp.to_nsec())

    def present(self) -> int:
        return rospy.Time.now().to_nsec()

    def warn(self, text: str) -> None:
        rospy.logwarn(text)


class Subscriber(SimpleFilter):
    """A filter that hands on the messages of a topic; takes what `rospy.Subscriber` takes but for the callback."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.topic = args[0]
        self.sub = rospy.Subscriber(*args, **{**kwargs, "callback": self.callback})

    def callback(self, msg: Any) -> None:
        """Hands on a message."""
        self.signalMessage(msg)

    def getTopic(self) -> Any:
        """The name of the topic."""
        return self.topic

    def __getattr__(self, key: str) -> Any:
        if key == "sub":  # it is not made yet
            raise AttributeError(key)
        return getattr(self.sub, key)


class Cache(_OfRospy, Cached):
    """Keeps the last messages of a filter, and hands them on."""

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__(f, cache_size, allow_headerless)

    def getOldestTime(self) -> Any:
        """The earliest stamp; None if there is none."""
        return genpy.Time(*divmod(min(self._stamps), 10**9)) if self._stamps else None

    def getLastestTime(self) -> Any:
        """The latest stamp; None if there is none. The name is as ROS has it."""
        return genpy.Time(*divmod(max(self._stamps), 10**9)) if self._stamps else None

    getLatestTime = getLastestTime


class TimeSynchronizer(_OfRospy, Synchronized):
    """Hands on messages of several filters together that have the same stamp. Time never jumps back, so that `reset` does
    nothing."""

    def __init__(self, fs: Any, queue_size: int, reset: bool = False) -> None:
        super().__init__(fs, queue_size)


class ApproximateTimeSynchronizer(_OfRospy, Approximated):
    """Hands on messages of several filters together whose stamps differ by less than `slop` seconds."""

    def __init__(self, fs: Any, queue_size: int, slop: float, allow_headerless: bool = False, reset: bool = False) -> None:
        self.slop = rospy.Duration.from_sec(slop)
        super().__init__(fs, queue_size, self.slop.to_nsec(), allow_headerless)
