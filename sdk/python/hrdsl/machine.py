"""What the program under test sees of the machine it happens to run on."""

from __future__ import annotations

import _thread
import itertools
import os
import sys

from hrdsl.replace import put, when_imported

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

#: One core, wherever and beside however many others a test runs.
CORES = frozenset({0})


def install(elapsed: Callable[[], float]) -> Callable[[], None]:
    """Replaces what tells of cores, load and resources used; `elapsed` is simulated time in seconds. What it returns is to be
    called when the program begins in a process that was forked for it."""

    def times() -> Any:
        now = elapsed()
        return os.times_result((now, 0.0, 0.0, 0.0, now))

    for name in ("cpu_count", "process_cpu_count"):
        put(name, lambda: len(CORES), os)
    put("getloadavg", lambda: (0.0, 0.0, 0.0), os)
    _affinity()
    _system_values()
    if hasattr(os, "times"):
        put("times", times, os)
    when_imported("resource", lambda module: _usage(module, elapsed))
    return _thread_numbers()


def _affinity() -> None:
    def get(pid: int) -> Any:
        return set(CORES) if pid in own() else real_get(pid)

    def set_(pid: int, mask: Iterable[int]) -> None:
        if pid not in own():
            real_set(pid, mask)
        elif not CORES.intersection(mask):
            raise OSError(22, "Invalid argument")

    def own() -> tuple[int, int]:
        return (0, os.getpid())

    real_get = put("sched_getaffinity", get, os)
    real_set = put("sched_setaffinity", set_, os)


def _system_values() -> None:
    numbers: dict[str, int] = getattr(os, "sysconf_names", {})
    names = ("SC_NPROCESSORS_CONF", "SC_NPROCESSORS_ONLN")
    cores = {*names, *map(numbers.get, names)}
    real = put("sysconf", lambda name: len(CORES) if name in cores else real(name), os)


def _thread_numbers() -> Callable[[], None]:
    """Threads are numbered from 1, in the order in which they are started."""
    numbers: dict[int, int] = {}
    count = itertools.count(1)

    def get_native_id() -> int:
        thread: int = real()
        if thread not in numbers:
            numbers[thread] = next(count)
        return numbers[thread]

    def begin() -> None:
        nonlocal count
        numbers.clear()
        count = itertools.count(1)
        threading: Any = sys.modules.get("threading")
        if threading is not None:
            threading.main_thread()._set_native_id()

    modules = [_thread] + [sys.modules[name] for name in ("threading",) if name in sys.modules]
    real = put("get_native_id", get_native_id, *modules)
    return begin


def _usage(module: Any, elapsed: Callable[[], float]) -> None:
    def getrusage(who: int) -> Any:
        spent = elapsed() if who in own else 0.0
        real(who)  # refuses what it does not know
        return module.struct_rusage((spent,) + (0.0,) + (0,) * 14)

    own = {getattr(module, name, None) for name in ("RUSAGE_SELF", "RUSAGE_THREAD")}
    real = put("getrusage", getrusage, module)
