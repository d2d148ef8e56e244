"""Clocks. All of them tell simulated time; those of the date begin on 2025-01-01, steady ones at 0.

A ROS clock tells the date, too, as without a simulator, and with the parameter `use_sim_time` no less: time is simulated
in any case, and the stamps of messages count from where this clock does. There is no topic `/clock`.
"""

from __future__ import annotations

from rclpy import _world
from rclpy.clock_type import ClockChange as ClockChange
from rclpy.clock_type import ClockType as ClockType
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class JumpThreshold:
    """Which jumps of a clock are told."""

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change


class TimeJump:
    """A jump of a clock."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self.clock_change = clock_change
        self.delta = delta


class JumpHandle:
    """Callbacks that hear of a clock's jumps, until they are unregistered."""

    def __init__(self, *, clock: Clock, threshold: JumpThreshold, pre_callback: Any, post_callback: Any) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        if post_callback is not None and not callable(post_callback):
            raise ValueError("post_callback must be callable if given")
        self.threshold, self.pre_callback, self.post_callback = threshold, pre_callback, post_callback
        self._clock: Clock | None = clock
        clock._jumps.append(self)

    def unregister(self) -> None:
        """They hear of no more."""
        if self._clock is not None:
            self._clock._jumps.remove(self)
            self._clock = None

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(self, *of_exception: object) -> None:
        self.unregister()


class Clock:
    """A clock of one kind."""

    _clock_type: ClockType
    _jumps: list[JumpHandle]
    _begins: int  # what it tells at simulated time 0

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Clock:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        self = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        self._clock_type = clock_type
        self._jumps = []
        self._begins = 0 if clock_type is ClockType.STEADY_TIME else _world.EPOCH
        return self

    @property
    def clock_type(self) -> ClockType:
        """Its kind."""
        return self._clock_type

    def __repr__(self) -> str:
        return "Clock(clock_type=%s)" % self._clock_type.name

    def now(self) -> Time:
        """The time it tells."""
        _world.looked("Clock.now")
        return Time(nanoseconds=self._begins + _world.now(), clock_type=self._clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], None] | None = None,
        post_callback: Callable[[TimeJump], None] | None = None,
    ) -> JumpHandle:
        """Calls these before and after a change of `use_sim_time`, by which this clock jumps over no time."""
        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback)

    def sleep_until(self, until: Time, context: Any = None) -> bool:
        """Waits for that time, or for the context's end: whether it was the former."""
        from rclpy.utilities import get_default_context

        if context is None:
            context = get_default_context()
        if not context.ok():
            raise NotInitializedException()
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        context._wait(until.nanoseconds - self._begins)
        return bool(context.ok())

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Waits for so long, or for the context's end: whether it was the former."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """The clock of nodes."""

    _is_active = False

    def __new__(cls) -> ROSClock:
        return super().__new__(cls, clock_type=ClockType.ROS_TIME)  # type: ignore[return-value]

    @property
    def ros_time_is_active(self) -> bool:
        """Whether `use_sim_time` is set, which changes nothing of what it tells."""
        return self._is_active

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._is_active:
            return
        heard = [each for each in self._jumps if each.threshold.on_clock_change]
        for each in heard:
            if each.pre_callback is not None:
                each.pre_callback()
        self._is_active = enabled
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        for each in heard:
            if each.post_callback is not None:
                each.post_callback(TimeJump(change, Duration()))

    def set_ros_time_override(self, time: Time) -> None:
        """Refused: time is the scenario's."""
        _world.unsupported("set_ros_time_override", "simulated time is the scenario's, and cannot be set")
