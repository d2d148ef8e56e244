"""Clocks and chance of the program under test come from simulated time and the test's seed."""

import os
import time

SECOND = 10**9  # an integer, since dividing integers rounds once

#: Simulated time 0 as a calendar date: 2025-01-01 00:00:00 UTC.
EPOCH = 1735689600 * SECOND


def install(link, seed):
    """Replaces the clocks, sleeps and sources of randomness of the standard library, for this process."""
    _chance(seed)
    _clocks(link)
    _dates(link)


def _chance(seed):
    import _random

    source = _random.Random(seed)

    def urandom(size):
        return source.getrandbits(8 * size).to_bytes(size, "little") if size else b""

    os.urandom = urandom
    if hasattr(os, "getrandom"):
        os.getrandom = lambda size, flags=0: urandom(size)

    import random

    random._urandom = urandom  # SystemRandom, and by it `secrets`
    random.seed(seed)


def _clocks(link):
    def elapsed():
        return link.time / SECOND

    def elapsed_ns():
        return link.time

    def wall():
        return (EPOCH + link.time) / SECOND

    def wall_ns():
        return EPOCH + link.time

    def sleep(seconds):
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        link.request({"request": "sleep", "seconds": float(seconds)})

    for name in ("monotonic", "perf_counter", "process_time", "thread_time"):
        setattr(time, name, elapsed)
        setattr(time, name + "_ns", elapsed_ns)
    time.time, time.time_ns, time.sleep = wall, wall_ns, sleep

    realtime = getattr(time, "CLOCK_REALTIME", None)
    time.clock_gettime = lambda clock: wall() if clock == realtime else elapsed()
    time.clock_gettime_ns = lambda clock: wall_ns() if clock == realtime else elapsed_ns()

    gmtime, localtime, ctime, asctime, strftime = time.gmtime, time.localtime, time.ctime, time.asctime, time.strftime
    time.gmtime = lambda secs=None: gmtime(wall() if secs is None else secs)
    time.localtime = lambda secs=None: localtime(wall() if secs is None else secs)
    time.ctime = lambda secs=None: ctime(wall() if secs is None else secs)
    time.asctime = lambda t=None: asctime(localtime(wall()) if t is None else t)
    time.strftime = lambda format, t=None: strftime(format, localtime(wall()) if t is None else t)


def _dates(link):
    # The C types cannot be patched, so subclasses take their place; in `_datetime`, from which `datetime` takes its
    # names when it is imported, or in `datetime` itself if that has been imported already.
    import sys

    try:
        import _datetime as module
    except ImportError:
        import datetime as module
    modules = [module] + ([sys.modules["datetime"]] if "datetime" in sys.modules else [])
    real_datetime, real_date = module.datetime, module.date

    class LikeReal(type):
        def __instancecheck__(cls, value):
            # Subclasses made by the program keep the usual meaning.
            return isinstance(value, cls._real) if "_real" in cls.__dict__ else super().__instancecheck__(value)

        def __subclasscheck__(cls, other):
            return issubclass(other, cls._real) if "_real" in cls.__dict__ else super().__subclasscheck__(other)

    class datetime(real_datetime, metaclass=LikeReal):
        _real = real_datetime

        @classmethod
        def now(cls, tz=None):
            return cls.fromtimestamp((EPOCH + link.time) / SECOND, tz)

        @classmethod
        def utcnow(cls):
            return cls.now(module.timezone.utc).replace(tzinfo=None)

        @classmethod
        def today(cls):
            return cls.now()

    class date(real_date, metaclass=LikeReal):
        _real = real_date

        @classmethod
        def today(cls):
            return cls.fromtimestamp((EPOCH + link.time) / SECOND)

    for kind in (datetime, date):
        kind.__module__, kind.__qualname__ = "datetime", kind.__name__
        for module in modules:
            setattr(module, kind.__name__, kind)
