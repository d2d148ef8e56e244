"""Timers, and rates that are made of them."""

from __future__ import annotations

import threading

from rclpy import _world
from rclpy._rclpy_pybind11 import InvalidHandle
from rclpy.exceptions import ROSInterruptException

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class Timer:
    """Runs a callback once in each period: at whole periods since it was made or reset, however late the last call was. Of
    calls that were missed one is made up for."""

    def __init__(
        self,
        callback: Any,
        callback_group: Any,
        timer_period_ns: int,
        clock: Any,
        *,
        context: Any = None,
        autostart: bool = True,
    ) -> None:
        if timer_period_ns < 0:
            raise ValueError("timer period must be non-negative")
        self.callback = callback
        self.callback_group = callback_group
        self._clock = clock
        self._period = int(timer_period_ns)
        self._last = _world.now()
        self._next = self._last + self._period
        self._is_canceled = not autostart
        self._executor_event = False
        self._is_destroyed = False
        self._wake: Callable[[], None] | None = None

    @property
    def clock(self) -> Any:
        """The clock whose time it is."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """Its period in nanoseconds."""
        return self._period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._period = int(value)

    def is_ready(self) -> bool:
        """Whether a call is due."""
        _world.looked("Timer.is_ready")
        return self._is_ready(_world.now())

    def _is_ready(self, now: int) -> bool:
        return self._next <= now and not self._is_canceled

    def _take(self) -> tuple[Any, tuple[Any, ...]] | None:
        if self._is_canceled or self.callback is None:
            return None
        now = _world.now()
        self._last = now
        following = self._next + self._period
        if following <= now:  # some were missed
            following = now if self._period == 0 else following + (1 + (now - following) // self._period) * self._period
        self._next = following
        return self.callback, ()

    def is_canceled(self) -> bool:
        """Whether it makes no calls."""
        return self._is_canceled

    def cancel(self) -> None:
        """Makes no more calls, until it is reset."""
        self._is_canceled = True

    def reset(self) -> None:
        """Begins again: the next call is one period from now."""
        self._next = _world.now() + self._period
        self._is_canceled = False
        if self._wake is not None:
            self._wake()

    def time_since_last_call(self) -> int:
        """In nanoseconds."""
        _world.looked("Timer.time_since_last_call")
        return _world.now() - self._last

    def time_until_next_call(self) -> int | None:
        """In nanoseconds; None if it is canceled."""
        _world.looked("Timer.time_until_next_call")
        return None if self._is_canceled else self._next - _world.now()

    def destroy(self) -> None:
        """Makes no more calls."""
        self._is_destroyed = self._is_canceled = True


class Rate:
    """Lets a thread go on once in each period, while another one spins the node."""

    def __init__(self, timer: Timer, *, context: Any) -> None:
        self._timer = timer
        self._is_shutdown = False
        self._is_destroyed = False
        self._event = threading.Event()
        self._sleepers = 0
        self._timer.callback = self._event.set
        context.on_shutdown(self._on_shutdown)

    def _on_shutdown(self) -> None:
        self._is_shutdown = True
        self.destroy()

    def destroy(self) -> None:
        """Lets all who sleep go on."""
        self._is_destroyed = True
        self._event.set()

    def sleep(self) -> None:
        """Waits for the timer. In a callback this may last for ever."""
        if self._is_shutdown:
            raise ROSInterruptException()
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if self._timer._is_destroyed:
            self.destroy()
            raise InvalidHandle("Rate cannot sleep because the timer has been destroyed")
        self._sleepers += 1
        try:
            self._event.wait()
        finally:
            self._sleepers -= 1
            if self._sleepers == 0:
                self._event.clear()
            if self._is_shutdown:
                self.destroy()
        if self._is_shutdown:
            raise ROSInterruptException()
