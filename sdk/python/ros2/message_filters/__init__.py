"""ROS 2's filters of messages: caches, and messages of several topics that belong together by their stamps."""

from __future__ import annotations

from hrdsl.filters import Approximated, Cached, SimpleFilter, Synchronized
from rclpy.clock import ROSClock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.time import Time

__all__ = ["ApproximateTimeSynchronizer", "Cache", "SimpleFilter", "Subscriber", "TimeSynchronizer"]

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class _OfRclpy:
    """How rclpy tells times and warns."""

    def nanoseconds(self, stamp: Any) -> int:
        return int((stamp if isinstance(stamp, Time) else Time.from_msg(stamp)).nanoseconds)

    def present(self) -> int:
        return ROSClock().now().nanoseconds

    def warn(self, text: str) -> None:
        get_logger("message_filters").warning(text)


class Subscriber(SimpleFilter):
    """A filter that hands on the messages of a topic: of a node, a class of messages and a name, with the options of
    `create_subscription` behind them. Without a profile it has a depth of 10."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node = args[0]
        self.topic = args[2]
        rest = args[3:]
        if rest:
            kwargs = {"qos_profile": rest[0], **kwargs}
        kwargs.setdefault("qos_profile", 10)
        self.sub = self.node.create_subscription(args[1], self.topic, self.callback, **kwargs)

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


class Cache(_OfRclpy, Cached):
    """Keeps the last messages of a filter, and hands them on."""

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__(f, cache_size, allow_headerless)

    def getOldestTime(self) -> Time | None:
        """The earliest stamp; None if there is none."""
        return Time(nanoseconds=min(self._stamps), clock_type=ClockType.ROS_TIME) if self._stamps else None

    def getLatestTime(self) -> Time | None:
        """The latest stamp; None if there is none."""
        return Time(nanoseconds=max(self._stamps), clock_type=ClockType.ROS_TIME) if self._stamps else None

    getLastestTime = getLatestTime  # which it was called before


class TimeSynchronizer(_OfRclpy, Synchronized):
    """Hands on messages of several filters together that have the same stamp."""

    def __init__(self, fs: Any, queue_size: int) -> None:
        super().__init__(fs, queue_size)


class ApproximateTimeSynchronizer(_OfRclpy, Approximated):
    """Hands on messages of several filters together whose stamps differ by less than `slop` seconds."""

    def __init__(self, fs: Any, queue_size: int, slop: float, allow_headerless: bool = False) -> None:
        self.slop = Duration(seconds=slop)
        super().__init__(fs, queue_size, self.slop.nanoseconds, allow_headerless)
