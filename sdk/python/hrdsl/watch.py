"""Finds loops that never wait, so that no other thread of the program ever runs."""

from __future__ import annotations

import os
import sys
import time

from hrdsl.errors import Busy
from hrdsl.schedule import _real_clock, _real_lock
from hrdsl.threads import _real_start

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from hrdsl.schedule import Scheduler, Task
    from hrdsl.threads import Threads


class Watcher:
    """A thread of the system's, beside those of the program, that looks now and then whether the scheduler was called.

    It changes nothing that the program sees unless it finds a fault: the thread that has the baton has computed for
    `budget` seconds of its processor time without a call, while another is ready, or waits for a time that cannot come.
    """

    def __init__(self, scheduler: Scheduler, threads: Threads, budget: float) -> None:
        self._scheduler = scheduler
        self._threads = threads
        self._budget = budget
        self._stop = _real_lock()
        self._stopped = _real_lock()

    def start(self) -> None:
        """Begins to look, until the process forks."""
        self._stop.acquire()
        self._stopped.acquire()
        _real_start(self._run, ())
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(before=self._end)

    def _end(self) -> None:
        """A forked process has one thread, and is told so; the next thread that is started brings a new watcher."""
        if self._stop.locked():
            self._stop.release()
            self._stopped.acquire()
            self._threads.on_first = self._again

    def _again(self) -> None:
        self._threads.on_first = None
        self._stop.acquire()
        _real_start(self._run, ())

    def _run(self) -> None:
        seen, since = (-1, -1), 0.0
        while not self._stop.acquire(True, min(1.0, max(0.01, self._budget / 4))):
            task = self._scheduler.running
            used = _processor_time(task)
            if used is None or (task.ident, self._scheduler.calls) != seen:
                seen, since = (task.ident, self._scheduler.calls), used or 0.0
            elif used - since > self._budget and self._keeps_others(task):
                self._found(task, used - since)
                break
        self._stopped.release()

    def _keeps_others(self, task: Task) -> bool:
        scheduler = self._scheduler
        return bool(scheduler.ready) or any(other.ticket for other in list(scheduler.tasks.values()) if other is not task)

    def _found(self, task: Task, used: float) -> None:
        from hrdsl import report

        sys.stderr.write(report.busy(self._scheduler, task, used))
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
        return _real_clock(time.pthread_getcpuclockid(task.ident)) if _real_clock is not None else None
    except (OSError, AttributeError, ValueError):
        return None
