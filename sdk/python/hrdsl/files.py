"""What the program under test sees of files: their order in a folder, and when they were changed."""

from __future__ import annotations

import os
import sys
import time
import types

from hrdsl.replace import put

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterator

    from hrdsl.link import Link

#: Times so far ahead of the real clock were not taken from it, but given by the program.
_AHEAD = 3600 * 10**9

_COARSE = 5  # Linux: the clock from which files get their times


def install(link: Link, now: Callable[[], int]) -> Callable[[], None]:
    """`now` is the simulated time of day in nanoseconds. What it returns is to be called when the program begins, if that is
    later."""
    times = _Times(now)
    for name in ("stat", "lstat", "fstat"):
        _with_times(name, times)
    real_listdir = put("listdir", lambda *args, **kwargs: sorted(real_listdir(*args, **kwargs)), os)
    real_scandir = put("scandir", lambda *args, **kwargs: _Scan(real_scandir(*args, **kwargs)), os)
    _Scan.entry = _entries(os.DirEntry, times)
    setattr(os, "DirEntry", _Scan.entry)
    if sys.platform == "linux" and _kernel() < (6, 13):
        link.before_request = times.settle
    return times.begin


def _with_times(name: str, times: _Times) -> None:
    real = put(name, lambda *args, **kwargs: times.shown(real(*args, **kwargs)), os)


def _kernel() -> tuple[int, ...]:
    """The version of the system's kernel. From Linux 6.13 on, a file that is changed after its times were read gets
    times other than those, however soon."""
    try:
        return tuple(int(part) for part in os.uname().release.split(".")[:2])
    except ValueError:
        return (0, 0)


def _file_clock() -> Callable[[], int]:
    if sys.platform != "linux":
        return time.time_ns
    clock = time.clock_gettime_ns
    return lambda: clock(_COARSE)


class _Times:
    """A file that has been changed since the program's start shows when the program first saw that, in simulated time.
    Older times are shown as they are. The time of the last access depends on how the file system is mounted and on
    who else read the file; in its place is that of the last change."""

    def __init__(self, now: Callable[[], int]) -> None:
        self._now = now
        self._clock = _file_clock()
        self._sleep = time.sleep
        self._first_seen: dict[tuple[int, int, int], int] = {}
        self._newest = 0
        self.begin()

    def begin(self) -> None:
        """What is changed from now on is changed by the program."""
        self._start = self._clock()

    def shown(self, real: os.stat_result) -> os.stat_result:
        reduced: Any = real.__reduce__()
        numbers, named = list(reduced[1][0]), reduced[1][1]
        for place, name in ((8, "st_mtime"), (9, "st_ctime"), (None, "st_birthtime")):
            seen = self._seen(real, named, name)
            if seen is not None:
                named[name] = seen / 10**9
                named[name + "_ns"] = seen
                if place:
                    numbers[place] = seen // 10**9
        numbers[7], named["st_atime"], named["st_atime_ns"] = numbers[8], named["st_mtime"], named["st_mtime_ns"]
        return os.stat_result(numbers, named)

    def _seen(self, real: os.stat_result, named: dict[str, Any], name: str) -> int | None:
        """When the program first saw this time of the file, in simulated time; None if it is older than the program."""
        nanos = named.get(name + "_ns")
        if nanos is None:
            nanos = int(named.get(name, 0) * 10**9)
        if nanos < self._start:
            return None
        key = (real.st_dev, real.st_ino, nanos)
        seen = self._first_seen.get(key)
        if seen is None:
            if nanos > self._clock() + _AHEAD:
                return None
            seen = self._first_seen[key] = self._now()
            self._newest = max(self._newest, nanos)
        return seen

    def settle(self) -> None:
        """Waits until a file that is changed from now on cannot have the times of one seen before: the clock of files
        ticks slowly, some hundred times a second."""
        for _ in range(100):
            if self._clock() > self._newest:
                break
            self._sleep(0.0005)


class _Scan:
    """What `os.scandir` returns, in the order of the names."""

    entry: Any = None

    def __init__(self, real: Any) -> None:
        with real:
            found = sorted(real, key=lambda entry: entry.name)
        self._entries: Iterator[Any] = iter([self.entry(entry) for entry in found])

    def __iter__(self) -> _Scan:
        return self

    def __next__(self) -> Any:
        return next(self._entries)

    def __enter__(self) -> _Scan:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        self._entries = iter(())


def _entries(real_kind: type, times: _Times) -> Any:
    class LikeReal(type):
        def __instancecheck__(cls, value: Any) -> bool:
            return isinstance(value, real_kind) or super().__instancecheck__(value)

    class DirEntry(metaclass=LikeReal):
        __slots__ = ("_real",)

        def __init__(self, real: Any) -> None:
            self._real = real

        @property
        def name(self) -> Any:
            return self._real.name

        @property
        def path(self) -> Any:
            return self._real.path

        def stat(self, *, follow_symlinks: bool = True) -> os.stat_result:
            return times.shown(self._real.stat(follow_symlinks=follow_symlinks))

        def __fspath__(self) -> Any:
            return self._real.path

        def __repr__(self) -> str:
            return repr(self._real)

        def __getattr__(self, name: str) -> Any:
            return getattr(self._real, name)  # inode, is_dir, is_file, …

        @classmethod
        def __class_getitem__(cls, item: Any) -> Any:
            return types.GenericAlias(cls, item)

    DirEntry.__module__, DirEntry.__qualname__, DirEntry.__doc__ = "os", "DirEntry", real_kind.__doc__
    return DirEntry
