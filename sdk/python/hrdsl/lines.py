"""Where the program's own code is, by simulated time: for each thread, the line of the covered files that it was at when it asked the
harness for something, told it the first thing of an instant, or began to wait. It is for looking at a run only."""

from __future__ import annotations

import _thread
import binascii
import os
import sys

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from types import CodeType
    from typing import Any, Iterable

    from hrdsl.link import Link
    from hrdsl.schedule import Scheduler, Task

#: So many lines are kept of a program, and so many of its threads are followed.
MOST_LINES = 100_000
MOST_THREADS = 50

_get_ident, _getframe = _thread.get_ident, sys._getframe


class ThreadLines:
    """The lines at which one thread was: columns of times (nanoseconds), places of files, and lines; 0 while it is in none of the files."""

    __slots__ = ("name", "times", "files", "lines", "code", "at")

    def __init__(self, name: str) -> None:
        self.name = name
        self.times: list[int] = []
        self.files: list[int] = []
        self.lines: list[int] = []
        self.code: CodeType | None = None  # in which it was last,
        self.at = -1  # and at which of its instructions


class LineRecorder:
    """Looks where the threads of a program are."""

    def __init__(self, files: Iterable[str], link: Link, scheduler: Scheduler) -> None:
        """The files are named as their coverage is."""
        self._names = list(files)
        self._places: dict[str, int] = {}  # of the files of code: -1 for those that are not asked for
        self._real = {os.path.realpath(name): place for place, name in enumerate(self._names)}
        self._link, self._scheduler = link, scheduler
        self._threads: dict[Task, ThreadLines] = {}
        self._kept = 0
        self._until: int | None = None
        self._unseen: set[Task] = set()

    def start(self) -> None:
        """Looks from now on: each time before a thread asks or waits, and at the first thing that it tells at an instant."""
        self._link.look = self._scheduler.look_at_lines = self.look

    def look(self) -> None:
        """Keeps the line at which the calling thread is, if it is another than before."""
        task = self._scheduler.running
        if task.ident != _get_ident():  # a thread that the scheduler does not run
            return
        frame: Any = _getframe(1)
        places = self._places
        while frame is not None:
            code = frame.f_code
            try:
                place = places[code.co_filename]
            except KeyError:
                place = self._place(code.co_filename)
            if place >= 0:
                break
            frame = frame.f_back
        thread = self._threads.get(task)
        if frame is None:
            if thread is not None and thread.code is not None:
                thread.code, thread.at = None, -1
                self._kept += 1
                thread.times.append(self._link.time)
                thread.files.append(thread.files[-1])
                thread.lines.append(0)
            return
        if thread is None:
            thread = self._begin(task)
            if thread is None:
                return
        at = frame.f_lasti
        if at == thread.at and code is thread.code:
            return
        thread.code, thread.at = code, at
        if self._kept >= MOST_LINES:
            self._stop()
            return
        self._kept += 1
        thread.times.append(self._link.time)
        thread.files.append(place)
        thread.lines.append(frame.f_lineno)

    def told(self) -> dict[str, Any]:
        """All of it: of the `files` the `name` and the `crc` (CRC-32) of their bytes; for each of the `threads` its `name` and its
        columns `t`, `file` and `line`, each as the first value and then the differences; when the last look was (`until`,
        nanoseconds), if there were too many lines; and how many threads were too many (`unseen`)."""
        threads = [
            {"name": each.name, "t": _differences(each.times), "file": _differences(each.files), "line": _differences(each.lines)}
            for each in self._threads.values()
        ]
        files = [{"name": name, "crc": _crc(name)} for name in self._names]
        return {"files": files, "threads": threads, "until": self._until, "unseen": len(self._unseen)}

    def _place(self, name: str) -> int:
        place = self._places[name] = self._real.get(os.path.realpath(name), -1)
        return place

    def _begin(self, task: Task) -> ThreadLines | None:
        if len(self._threads) >= MOST_THREADS:
            self._unseen.add(task)
            return None
        threading: Any = sys.modules.get("threading")
        known = threading._active.get(task.ident) if threading is not None else None
        thread = ThreadLines("MainThread" if known is None else str(known.name))
        self._threads[task] = thread
        return thread

    def _stop(self) -> None:
        self._until = self._link.time
        self._link.look = self._scheduler.look_at_lines = None


def _differences(values: list[int]) -> list[int]:
    return [value - before for value, before in zip(values, [0, *values])]


def _crc(name: str) -> int | None:
    try:
        with open(name, "rb") as file:
            return binascii.crc32(file.read())
    except OSError:
        return None
