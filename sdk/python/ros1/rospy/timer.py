"""Pauses, rates and timers."""

from __future__ import annotations

import threading
import time

import genpy
from hrdsl import told
from rospy import core, rostime
from rospy.exceptions import ROSInterruptException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

_SECOND = 10**9


def sleep(duration: Any) -> None:
    """Lets time pass: seconds, or a `Duration`; less than nothing is nothing."""
    if isinstance(duration, genpy.Duration):
        duration = duration.to_sec()
    if duration < 0:
        return
    time.sleep(duration)


class Rate:
    """Pauses in a loop, so that it runs so often in a second."""

    def __init__(self, hz: float, reset: bool = False) -> None:
        self._last = rostime.nanoseconds()
        self._period = int(1e9 / hz)
        self._reset = reset

    @property
    def last_time(self) -> rostime.Time:
        """When the last pause should have ended."""
        return rostime.Time(0, self._last)

    @last_time.setter
    def last_time(self, value: rostime.Time) -> None:
        self._last = value.to_nsec()

    @property
    def sleep_dur(self) -> rostime.Duration:
        """From the end of a pause to that of the next."""
        return rostime.Duration(0, self._period)

    @sleep_dur.setter
    def sleep_dur(self, value: rostime.Duration) -> None:
        self._period = value.to_nsec()

    def remaining(self) -> rostime.Duration:
        """How long the next pause would be."""
        return rostime.Duration(0, self._period - (rostime.nanoseconds() - self._last))

    def sleep(self) -> None:
        """Pauses until it is time; a loop that is late by more than two turns begins anew."""
        now = rostime.nanoseconds()
        rest = self._period - (now - self._last)
        if rest >= 0:
            time.sleep(rest / 1e9)
        self._last += self._period
        if now - self._last > 2 * self._period:
            self._last = now


class TimerEvent:
    """What a timer's callback is told: when it was to be called and was, this time and the last, and how long it took then."""

    def __init__(self, last_expected: Any, last_real: Any, current_expected: Any, current_real: Any, last_duration: Any) -> None:
        self.last_expected = last_expected
        self.last_real = last_real
        self.current_expected = current_expected
        self.current_real = current_real
        self.last_duration = last_duration


class Timer(threading.Thread):
    """Calls a function at a rate, or once, in a thread of its own."""

    def __init__(self, period: Any, callback: Callable[[TimerEvent], Any], oneshot: bool = False, reset: bool = False) -> None:
        super().__init__()
        self._period = period
        self._callback = callback
        self._oneshot = oneshot
        self._reset = reset
        self._shutdown = False
        self.daemon = True
        self.start()

    def shutdown(self) -> None:
        """Calls no more."""
        self._shutdown = True

    def run(self) -> None:
        try:
            self._run()
        except Exception as error:
            core.failed("timer of %g s: %s" % (self._period.to_sec(), told.name_of(self._callback)), error)
            raise

    def _run(self) -> None:
        rate = Rate(1.0 / self._period.to_sec(), reset=self._reset)
        expected = rostime.get_rostime() + self._period
        last_expected = last_real = last_duration = None
        while not core.is_shutdown() and not self._shutdown:
            try:
                rate.sleep()
            except ROSInterruptException:
                if core.is_shutdown():
                    break
                raise
            if self._shutdown:
                break
            real = rostime.get_rostime()
            start = time.time()
            self._callback(TimerEvent(last_expected, last_real, expected, real, last_duration))
            if self._oneshot:
                break
            last_duration = time.time() - start
            last_expected, last_real = expected, real
            expected += self._period
