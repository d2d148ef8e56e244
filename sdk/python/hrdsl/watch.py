"""Finds loops that never wait, so that no other thread of the program ever runs, and no time passes."""

from __future__ import annotations

import _thread
import os
import sys
import time

from hrdsl.errors import Busy
from hrdsl.schedule import real_clock, real_lock, real_sleep
from hrdsl.threads import real_start

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

    from hrdsl.schedule import Scheduler, Task
    from hrdsl.threads import Threads

#: Bytes of its stack.
_STACK = 1 << 20

#: After so many seconds of real time, at most, the interpreter takes a processor away from a thread that others wait for. It is
#: longer than a busy machine keeps a thread from running: one that has handed over the baton comes to its own wait before the next
#: begins, and whatever both make, they make in the same order in every run.
_SWITCH = 0.5

#: The same while there is a fault to be told of, beside a thread that does not wait.
_PROMPT = 0.001

#: The clock of what the process has computed.
_COMPUTED = getattr(time, "CLOCK_PROCESS_CPUTIME_ID", None)

_real_nanos = getattr(time, "clock_gettime_ns", None)  # as it is before anything is replaced


class Watcher:
    """A thread of the system's, beside those of the program, that looks now and then whether the scheduler was called.

    Now and then is measured in processor time where the system can: a program that computes little is never looked at, however long
    that takes on a busy machine, and so has the same objects at the same addresses in every run. It changes nothing that the program
    sees unless it finds a fault: the thread that has the baton has computed for `budget` seconds of its processor time without a
    call, while another is ready, or waits for a time that cannot come. Of a thread that computes for so long while nobody waits, it
    tells the place, since the harness soon ends a program that makes no request.
    """

    def __init__(self, scheduler: Scheduler, threads: Threads, budget: float) -> None:
        self._scheduler = scheduler
        self._threads = threads
        self._budget = budget
        self._every = max(0.01, budget / 6)  # seconds between looks, while all is well
        self._switch = min(_SWITCH, self._every / 4)
        self._stop: Any = None  # released to end it, while it runs
        self._stopped: Any = None
        self._begun: Any = None

    def start(self) -> None:
        """Begins to look, until the process forks."""
        sys.setswitchinterval(self._switch)
        self._go()
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(before=self._end)

    def _go(self) -> None:
        self._threads.on_first = None
        self._stop, self._stopped, self._begun = real_lock(), real_lock(), real_lock()
        for lock in (self._stop, self._stopped, self._begun):
            lock.acquire()
        size = _thread.stack_size(_STACK)
        try:
            real_start(self._run, ())
            self._begun.acquire()  # so that what it makes is made now, not beside the program
        except RuntimeError:  # the system lets it have no more threads, and the program may need none
            self._stop = None
        finally:
            _thread.stack_size(size)

    def _end(self) -> None:
        """A forked process has one thread, and the interpreter warns of more; the next thread that the program starts
        brings a new watcher."""
        if self._stop is not None:
            self._stop.release()
            self._stopped.acquire()
            self._stop = None
            self._threads.on_first = self._go
        for _ in range(20):  # what has ended is counted for a moment longer
            if _system_threads() <= len(self._scheduler.tasks):
                break
            real_sleep(0.0005)

    def _run(self) -> None:
        stop, stopped = self._stop, self._stopped
        seen, since = (-1, -1), 0.0
        heard, silent_since = -1, 0.0  # requests, which let nobody else run
        self._begun.release()  # nobody else runs before this thread waits (`_SWITCH`)
        seconds = self._every
        while not self._wait(stop, seconds):
            seconds = self._every
            task = self._scheduler.running
            used = _processor_time(task)
            if used is None or (task.ident, self._scheduler.calls) != seen:
                seen, since = (task.ident, self._scheduler.calls), used or 0.0
                heard, silent_since = self._scheduler.outside.asked, since
            elif used - since > self._budget and self._keeps_others(task):
                self._found(task)
                break
            elif self._scheduler.outside.asked != heard:
                heard, silent_since = self._scheduler.outside.asked, used
            elif used - silent_since > self._budget:
                self._tell(task)
                silent_since = float("inf")  # once is enough, until something is asked again
            if used is not None:  # the next look is when the budget is used up, if all stays as it is
                left = self._budget - (used - min(since, silent_since))
                seconds = left if 0 < left < self._budget else self._every
        stopped.release()

    def _wait(self, stop: Any, seconds: float) -> bool:
        """Until the process has used so much of its processor: whether it is the end instead."""
        if _real_nanos is None or _COMPUTED is None:
            return bool(stop.acquire(True, seconds))
        step = self._every / 16
        until = _real_nanos(_COMPUTED) + int(seconds * 1e9)
        while not stop.acquire(True, step):
            # The number that this line makes is gone at once, and its place is the next again, so that the program's objects are
            # where they would be without it. (A float would be kept for the next float.)
            if _real_nanos(_COMPUTED) >= until:
                return False
        return True

    def _keeps_others(self, task: Task) -> bool:
        scheduler = self._scheduler
        if scheduler.ready or any(other.ticket for other in list(scheduler.tasks.values()) if other is not task):
            return True
        # A message that a callback waits for comes when time passes, and not before.
        return scheduler.outside.can_arrive()

    def _tell(self, task: Task) -> None:
        sys.setswitchinterval(_PROMPT)
        from hrdsl import report

        sys.stderr.write(report.silent(self._scheduler, task, self._budget))
        sys.stderr.flush()
        sys.setswitchinterval(self._switch)

    def _found(self, task: Task) -> None:
        sys.setswitchinterval(_PROMPT)
        from hrdsl import report

        sys.stderr.write(report.busy(self._scheduler, task, self._budget))
        self._scheduler.end(Busy)
        try:
            import ctypes

            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(task.ident), ctypes.py_object(Busy))
        except Exception:  # there is no other way to end a loop of another thread
            sys.stderr.flush()
            os._exit(1)


def _processor_time(task: Task) -> float | None:
    """What the thread has used; None if it has ended, or nobody can tell."""
    try:
        return real_clock(time.pthread_getcpuclockid(task.ident)) if real_clock is not None else None
    except (OSError, AttributeError, ValueError):
        return None


def _system_threads() -> int:
    try:
        return os.stat("/proc/self/task").st_nlink - 2
    except OSError:
        return 0
