"""The time of the node: the simulated one, counted from 1970 as that of the clock on the wall."""

from __future__ import annotations

import time

import genpy
from rospy.exceptions import ROSInitException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_rostime_initialized = False


class Duration(genpy.Duration):
    """A span of time."""

    __slots__: list[str] = []

    def __repr__(self) -> str:
        return "rospy.Duration[%d]" % self.to_nsec()


class Time(genpy.Time):
    """A point in time."""

    __slots__: list[str] = []

    def __repr__(self) -> str:
        return "rospy.Time[%d]" % self.to_nsec()

    @staticmethod
    def now() -> Time:
        """The present."""
        return get_rostime()

    @classmethod
    def from_seconds(cls, float_secs: float) -> Any:
        """As `from_sec`."""
        return cls.from_sec(float_secs)


def get_rostime() -> Time:
    """The present."""
    return Time(*divmod(nanoseconds(), 10**9))


def nanoseconds() -> int:
    """The present, since 1970."""
    if not _rostime_initialized:
        raise ROSInitException("time is not initialized. Have you called init_node()?")
    return time.time_ns()


def get_time() -> float:
    """The present in seconds."""
    return get_rostime().to_sec()


def set_rostime_initialized(val: bool) -> None:
    """Whether the node has its time."""
    global _rostime_initialized
    _rostime_initialized = val


def is_rostime_initialized() -> bool:
    return _rostime_initialized


def is_wallclock() -> bool:
    return True


def switch_to_wallclock() -> None:
    """Nothing: it is the clock on the wall already."""


def wallsleep(duration: float) -> None:
    """Lets time pass."""
    time.sleep(duration)
