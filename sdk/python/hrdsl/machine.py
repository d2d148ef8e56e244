"""What the program under test sees of the machine it happens to run on."""

import _thread
import itertools
import os
import sys

from hrdsl.replace import put, when_imported

#: One core, wherever and beside however many others a test runs.
CORES = frozenset({0})


def install(elapsed):
    """Replaces what tells of cores, load and resources used; `elapsed` is simulated time in seconds."""
    for name in ("cpu_count", "process_cpu_count"):
        put(name, lambda: len(CORES), os)
    put("getloadavg", lambda: (0.0, 0.0, 0.0), os)
    _affinity()
    _system_values()
    _thread_numbers()
    if hasattr(os, "times"):
        put("times", lambda: os.times_result((elapsed(), 0.0, 0.0, 0.0, elapsed())), os)
    when_imported("resource", lambda module: _usage(module, elapsed))


def _affinity():
    def get(pid):
        return set(CORES) if pid in own() else real_get(pid)

    def set_(pid, mask):
        if pid not in own():
            return real_set(pid, mask)
        if not CORES.intersection(mask):
            raise OSError(22, "Invalid argument")

    def own():
        return (0, os.getpid())

    real_get = put("sched_getaffinity", get, os)
    real_set = put("sched_setaffinity", set_, os)


def _system_values():
    numbers = getattr(os, "sysconf_names", {})
    cores = {"SC_NPROCESSORS_CONF", "SC_NPROCESSORS_ONLN"}
    cores |= {numbers.get(name) for name in cores}
    real = put("sysconf", lambda name: len(CORES) if name in cores else real(name), os)


def _thread_numbers():
    """Threads are numbered from 1, in the order in which they are started."""
    numbers, count = {}, itertools.count(1)

    def get_native_id():
        thread = real()
        if thread not in numbers:
            numbers[thread] = next(count)
        return numbers[thread]

    modules = [_thread] + [sys.modules[name] for name in ("threading",) if name in sys.modules]
    real = put("get_native_id", get_native_id, *modules)


def _usage(module, elapsed):
    def getrusage(who):
        spent = elapsed() if who in own else 0.0
        real(who)  # refuses what it does not know
        return module.struct_rusage((spent,) + (0.0,) + (0,) * 14)

    own = {getattr(module, name, None) for name in ("RUSAGE_SELF", "RUSAGE_THREAD")}
    real = put("getrusage", getrusage, module)
