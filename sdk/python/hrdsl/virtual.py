"""Clocks, chance and the machine, as the program under test sees them: from simulated time and the test's seed."""

from __future__ import annotations

import sys
import time
import types

from hrdsl import chance, dates, files, machine, outside
from hrdsl.replace import put
from hrdsl.schedule import POLLS

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.link import Link
    from hrdsl.schedule import Scheduler

SECOND = 10**9  # an integer, since dividing integers rounds once

#: Simulated time 0 as a calendar date: 2025-01-01 00:00:00 UTC.
EPOCH = 1735689600 * SECOND


class Simulation:
    """What is replaced in this process."""

    def __init__(self, link: Link, seed: int) -> None:
        """Replaces what the standard library tells of time, chance and the machine, for this process, and what waits."""
        self.scheduler, self.watch = outside.install(link)
        self._begin_files = files.install(link, lambda: EPOCH + link.time)  # before the clocks, as it needs the real one
        self.chance = chance.install(seed)
        now = _polled_clock(self.scheduler, link)
        self._begin_threads = machine.install(lambda: now() / SECOND)
        _clocks(self.scheduler, now)
        dates.install(lambda: (EPOCH + now()) / SECOND)

    def begin(self, seed: int) -> None:
        """To be called where the program begins later than this was made, in a process that was forked for it: nothing of what
        was done before shows."""
        self.scheduler.begin_anew()
        self._begin_files()
        self._begin_threads()
        self.chance.begin(seed)


def _polled_clock(scheduler: Scheduler, link: Link) -> Callable[[], int]:
    def now() -> int:
        # As `Scheduler.polled` does: a program that reads the clock again and again waits for it to move.
        scheduler.polls += 1
        if scheduler.polls >= POLLS:
            scheduler.much_polled()
        return link.time

    return now


def _clocks(scheduler: Scheduler, now: Callable[[], int]) -> None:
    def elapsed() -> float:
        return now() / SECOND

    def elapsed_ns() -> int:
        return now()

    def wall() -> float:
        return (EPOCH + now()) / SECOND

    def wall_ns() -> int:
        return EPOCH + now()

    def sleep(seconds: float) -> None:
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if seconds != seconds:
            raise ValueError("Invalid value NaN (not a number)")
        scheduler.sleep(seconds)

    for name in ("monotonic", "perf_counter", "process_time", "thread_time"):
        put(name, elapsed, time)
        put(name + "_ns", elapsed_ns, time)
    put("time", wall, time)
    put("time_ns", wall_ns, time)
    put("sleep", sleep, time)
    _system_clocks(wall, wall_ns, elapsed, elapsed_ns)
    _calendar(wall)


def _system_clocks(
    wall: Callable[[], float], wall_ns: Callable[[], int], elapsed: Callable[[], float], elapsed_ns: Callable[[], int]
) -> None:
    # The last two are Linux's coarse clock and its alarm clock of the time of day.
    of_the_day = {getattr(time, name, None) for name in ("CLOCK_REALTIME", "CLOCK_TAI")} | {5, 8}
    if sys.platform != "linux":
        of_the_day = {getattr(time, "CLOCK_REALTIME", None)}

    def gettime(clock: int) -> float:
        real(clock)  # refuses what is no clock
        return wall() if clock in of_the_day else elapsed()

    def gettime_ns(clock: int) -> int:
        real(clock)
        return wall_ns() if clock in of_the_day else elapsed_ns()

    def settime(clock: int, value: float) -> None:
        raise PermissionError(1, "Operation not permitted")

    def getres(clock: int) -> float:
        real(clock)
        return 1 / SECOND

    def info(name: Any) -> Any:
        found = real_info(name)
        simulated = {"implementation": "simulated time", "resolution": 1 / SECOND, "adjustable": False}
        return types.SimpleNamespace(**{**vars(found), **simulated})

    real = put("clock_gettime", gettime, time)
    put("clock_gettime_ns", gettime_ns, time)
    put("clock_settime", settime, time)
    put("clock_settime_ns", settime, time)
    put("clock_getres", getres, time)
    real_info = put("get_clock_info", info, time)


def _calendar(wall: Callable[[], float]) -> None:
    gmtime, localtime, ctime, asctime, strftime = time.gmtime, time.localtime, time.ctime, time.asctime, time.strftime
    put("gmtime", lambda secs=None: gmtime(wall() if secs is None else secs), time)
    put("localtime", lambda secs=None: localtime(wall() if secs is None else secs), time)
    put("ctime", lambda secs=None: ctime(wall() if secs is None else secs), time)
    put("asctime", lambda t=None: asctime(localtime(wall()) if t is None else t), time)
    put("strftime", lambda format, t=None: strftime(format, localtime(wall()) if t is None else t), time)
