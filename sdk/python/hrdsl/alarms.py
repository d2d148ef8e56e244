"""Signals that a program asks to be sent later, in simulated time: `signal.alarm`, `setitimer`, `pause`.

The one alarm of a process is a thread of the scheduler's that lives while the alarm is set, waits for its time and sends the signal, as
another thread of the program could. What counts processor time, or takes signals without a handler, is refused.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`
import sys

from hrdsl.errors import Unsupported
from hrdsl.locks import after
from hrdsl.replace import put

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

    from hrdsl.schedule import Scheduler, Task
    from hrdsl.threads import Threads

SECOND = 10**9

#: What the main thread waits for in `signal.pause`.
PAUSE = "pause"

real_alarm: Any = getattr(_signal, "alarm", None)

_INSTEAD = "handle the signal with signal.signal, and wait with signal.pause or time.sleep"


class AlarmClock:
    """The alarm of this process."""

    def __init__(self, scheduler: Scheduler, threads: Threads) -> None:
        self._scheduler = scheduler
        self._threads = threads
        self._at: int | None = None  # simulated nanoseconds
        self._every = 0
        self._task: Task | None = None  # the thread, while there is one

    def set(self, seconds: float, interval: float = 0.0) -> tuple[float, float]:
        """Sends SIGALRM after so many seconds, and then again and again after `interval`; for 0, never. What was left of the last one."""
        before = self.left()
        if seconds < 0 or interval < 0:
            raise _signal.ItimerError(22, "Invalid argument")
        self._every = round(interval * SECOND)
        self._at = after(seconds) if seconds else None
        if self._task is not None:
            self._scheduler.unpark(self._task)  # which waits for another time now, or ends
        elif self._at is not None:
            self._task = self._threads.start(self._run, (), {}, self._ended)
        return before

    def left(self) -> tuple[float, float]:
        """The seconds until it is due, and its interval."""
        if self._at is None:
            return 0.0, 0.0
        return (max(1, self._at - self._scheduler.outside.time)) / SECOND, self._every / SECOND

    def _run(self) -> None:
        scheduler = self._scheduler
        while self._at is not None:
            if self._at > scheduler.outside.time:
                scheduler.park("alarm", self._at)
                continue
            self._at = self._at + self._every if self._every else None
            _signal.raise_signal(_signal.SIGALRM)

    def _ended(self) -> None:
        self._task = None


def install(scheduler: Scheduler, threads: Threads) -> None:
    """Replaces the alarms of this process."""
    clock = AlarmClock(scheduler, threads)
    modules = [_signal] + [sys.modules[name] for name in ("signal",) if name in sys.modules]
    if real_alarm is None:
        return

    def alarm(seconds: int, /) -> int:
        left, _ = clock.set(max(0, int(seconds)))
        return -(-round(left * SECOND) // SECOND)

    def setitimer(which: int, seconds: float, interval: float = 0.0, /) -> tuple[float, float]:
        _check_timer(which)
        return clock.set(seconds, interval)

    def getitimer(which: int, /) -> tuple[float, float]:
        _check_timer(which)
        scheduler.polled("alarm")
        return clock.left()

    def pause() -> None:
        me = scheduler.current()
        if me is None or me is not scheduler.main:
            raise Unsupported("signal.pause in another thread than the main one, which handles signals, would end never; wait there for an Event")
        scheduler.park(PAUSE)

    for function in (alarm, setitimer, getitimer, pause):
        put(function.__name__, function, *modules)
    for name in ("sigwait", "sigwaitinfo", "sigtimedwait"):
        put(name, _refusal(name), *modules)


def _check_timer(which: int) -> None:
    if which in (_signal.ITIMER_VIRTUAL, _signal.ITIMER_PROF):
        raise Unsupported(
            "a timer of processor time (ITIMER_VIRTUAL, ITIMER_PROF) would depend on the machine: no simulated time passes while a program"
            " computes; use ITIMER_REAL"
        )
    if which != _signal.ITIMER_REAL:
        raise _signal.ItimerError(22, "Invalid argument")


def _refusal(name: str) -> Callable[..., NoReturn]:
    def refuse(*args: Any, **how: Any) -> NoReturn:
        raise Unsupported("signal.%s waits in real time, beside the simulated one; %s" % (name, _INSTEAD))

    return refuse
