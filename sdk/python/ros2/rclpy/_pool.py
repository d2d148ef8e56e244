"""The threads of an executor: as those of `concurrent.futures`, but idle ones end with the test without a word."""

from __future__ import annotations

import threading

from hrdsl.errors import Stopped
from hrdsl.mailbox import Mailbox

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

_pools = 0


class Pool:
    """Threads that are started when they are needed, up to so many."""

    def __init__(self, most: int) -> None:
        global _pools
        if most <= 0:
            raise ValueError("max_workers must be greater than 0")
        self._most = most
        self._jobs = Mailbox()
        self._idle = 0  # threads that have nothing to do, or are given something
        self._threads: list[threading.Thread] = []
        self._name = "ThreadPoolExecutor-%d" % _pools
        _pools += 1
        at_end: Any = getattr(threading, "_register_atexit", None)
        if at_end is not None:
            at_end(self._join)

    def submit(self, job: Callable[[], Any]) -> None:
        """Lets a thread do it."""
        self._jobs.put(job)
        if self._idle:
            self._idle -= 1
        elif len(self._threads) < self._most:
            name = "%s_%d" % (self._name, len(self._threads))
            thread = threading.Thread(target=self._work, name=name, daemon=True)
            self._threads.append(thread)
            thread.start()

    def _work(self) -> None:
        while True:
            job = self._jobs.get()
            if job is None:
                return
            try:
                job()
            except Stopped:
                raise
            except BaseException:  # such as SystemExit, which ends only the callback in a pool
                pass
            del job
            self._idle += 1

    def _join(self) -> None:
        """At the end of the program: waits for what is being done."""
        for _ in self._threads:
            self._jobs.put(None)
        for thread in self._threads:
            thread.join()
