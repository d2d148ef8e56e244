"""The exceptions and enumerations that are written in C++ in ROS; programs import them from here now and then."""

from __future__ import annotations

from enum import Enum

from rclpy.clock_type import ClockChange as ClockChange
from rclpy.clock_type import ClockType as ClockType


class RCLError(RuntimeError):
    """What the layers below have refused."""


class RCLInvalidROSArgsError(RCLError):
    """Arguments after `--ros-args` that cannot be understood."""


class UnknownROSArgsError(RuntimeError):
    """Arguments after `--ros-args` that nobody knows."""


class NodeNameNonExistentError(RCLError):
    """There is no such node."""


class UnsupportedEventTypeError(RCLError):
    """An event that the middleware does not have."""


class InvalidHandle(RuntimeError):
    """What was destroyed cannot be used any more."""


class SignalHandlerOptions(Enum):
    """Which signals `rclpy.init` is to handle."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


class QoSCompatibility(Enum):
    """Whether a publisher and a subscription can talk."""

    OK = 0
    WARNING = 1
    ERROR = 2


class GoalEvent(Enum):
    """What can happen to a goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4
