"""The event loop of `asyncio` in simulated time.

It is the library's own loop for Unix, over a selector that waits in the scheduler: a loop without anything to do is a
thread that waits until its next timer, or until `call_soon_threadsafe` wakes it. Transports of sockets, pipes and child
processes work; their descriptors are asked whenever the loop has nothing else to do at an instant.
"""

from __future__ import annotations

import os
import sys

from hrdsl.errors import Unsupported
from hrdsl.waits import Ready, wait

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

    from hrdsl.schedule import Scheduler, Task


def install(asyncio: Any, scheduler: Scheduler) -> None:
    """Makes it the loop of the default policy, and what `asyncio.SelectorEventLoop` is."""
    unix = sys.modules.get("asyncio.unix_events")
    if unix is None:
        return
    kind = _loop(asyncio, unix, _selector(scheduler), scheduler)
    if scheduler.is_drawn:
        kind = _drawn(asyncio, kind, scheduler)
    module: Any = unix
    for name in ("_UnixDefaultEventLoopPolicy", "DefaultEventLoopPolicy"):
        if hasattr(module, name):
            getattr(module, name)._loop_factory = kind
    module.SelectorEventLoop = module._UnixSelectorEventLoop = asyncio.SelectorEventLoop = kind
    for place in (module, asyncio):
        if hasattr(place, "EventLoop"):  # from Python 3.13 on
            place.EventLoop = kind
    if sys.version_info < (3, 12):
        _child_watcher(asyncio, module)


def _selector(scheduler: Scheduler) -> Any:
    import selectors

    class Selector(selectors.DefaultSelector):  # type: ignore[misc, valid-type, unused-ignore]
        """Waits in the scheduler, for descriptors if it has some."""

        def __init__(self) -> None:
            super().__init__()
            self.task: Task | None = None  # that waits in it
            self.is_woken = False
            self._files: Any = self._fd_to_key  # type: ignore[attr-defined]

        def select(self, timeout: float | None = None) -> Any:
            if not self._files:
                return self._sleep(timeout)
            watch = Ready(lambda: self._now() or self.is_woken, self._masks)
            try:
                self.task = scheduler.current()
                wait(scheduler, watch, timeout)
            finally:
                self.task, self.is_woken = None, False
            return watch.found if isinstance(watch.found, list) else []

        def _sleep(self, timeout: float | None) -> Any:
            if timeout is not None and timeout <= 0 or self.is_woken:
                self.is_woken = False
                return ()
            self.task = scheduler.current()
            if self.task is not None:
                deadline = None if timeout is None else scheduler.outside.time + max(1, round(timeout * 1e9))
                try:
                    scheduler.park(self, deadline)
                finally:
                    self.task, self.is_woken = None, False
            return ()

        def _now(self) -> Any:
            return super().select(0)

        def _masks(self) -> list[tuple[int, int]]:
            return [(key.fd, 1 * bool(key.events & 1) | 4 * bool(key.events & 2)) for key in self._files.values()]

        def wake(self) -> None:
            self.is_woken = True
            if self.task is not None:
                scheduler.unpark(self.task)

    return Selector


def _loop(asyncio: Any, unix: Any, selector: Any, scheduler: Scheduler) -> Any:
    real = unix._UnixSelectorEventLoop
    outside = scheduler.outside

    class SelectorEventLoop(real):  # type: ignore[misc, valid-type]
        """A loop whose time is the simulated one."""

        def __init__(self, given: Any = None) -> None:
            super().__init__(selector())
            self._clock_resolution = 1e-9

        def time(self) -> float:
            return outside.time / 1e9

        # Signals alone need the pipe to itself that a loop has for being woken.

        def _make_self_pipe(self) -> None:
            self._ssock = self._csock = None

        def _close_self_pipe(self) -> None:
            if self._ssock is not None:
                super()._close_self_pipe()

        def _write_to_self(self) -> None:
            self._selector.wake()

        def add_signal_handler(self, sig: int, callback: Any, *args: Any) -> None:
            if self._ssock is None:
                super()._make_self_pipe()
            super().add_signal_handler(sig, callback, *args)

    SelectorEventLoop.__module__, SelectorEventLoop.__qualname__ = real.__module__, real.__qualname__
    return SelectorEventLoop


def _drawn(asyncio: Any, real: Any, scheduler: Scheduler) -> Any:
    """A loop whose order the schedule draws, as far as `asyncio` leaves it open: which of the tasks that are ready goes on first, and
    which of the timers of one instant is called first. What `call_soon` is given keeps its place, since its order is promised."""
    import heapq

    class SelectorEventLoop(real):  # type: ignore[misc, valid-type]
        """A loop with an order of its own."""

        def _process_events(self, event_list: Any) -> None:
            # Once in each turn, before its timers are put behind what is ready, and before anything is called.
            super()._process_events(event_list)
            ready, timers = self._ready, self._scheduled
            if len(ready) > 1:
                places = [place for place, handle in enumerate(ready) if _is_of_task(asyncio, handle)]
                tasks = [ready[place] for place in places]
                scheduler.shuffle(tasks)
                for place, handle in zip(places, tasks):
                    ready[place] = handle
            if len(timers) > 1 and timers[0]._when < self.time() + self._clock_resolution:
                # Those of the same instant leave the heap as they lie in it.
                scheduler.shuffle(timers)
                heapq.heapify(timers)

    SelectorEventLoop.__module__, SelectorEventLoop.__qualname__ = real.__module__, real.__qualname__
    return SelectorEventLoop


def _is_of_task(asyncio: Any, handle: Any) -> bool:
    return isinstance(getattr(handle._callback, "__self__", None), asyncio.Task)


def _child_watcher(asyncio: Any, unix: Any) -> None:
    """Up to Python 3.11 a thread waits for each child in C code, which would keep all others from running. In its place
    the loop watches a descriptor of the process, as later versions do."""

    class Watcher(unix.AbstractChildWatcher):  # type: ignore[misc]
        def add_child_handler(self, pid: int, callback: Any, *args: Any) -> None:
            if not hasattr(os, "pidfd_open"):
                raise Unsupported("asyncio waits for child processes from Python 3.9 on, on Linux; use subprocess")
            loop, descriptor = asyncio.get_running_loop(), os.pidfd_open(pid)

            def ended() -> None:
                loop._remove_reader(descriptor)
                try:
                    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
                except ChildProcessError:  # somebody else has waited for it
                    status = 255
                os.close(descriptor)
                callback(pid, status, *args)

            loop._add_reader(descriptor, ended)

        def remove_child_handler(self, pid: int) -> bool:
            return True  # asyncio never takes a handler back, but at the end of its child

        def attach_loop(self, loop: Any) -> None:
            pass

        def close(self) -> None:
            pass

        def is_active(self) -> bool:
            return True

        def __enter__(self) -> Watcher:
            return self

        def __exit__(self, *exception: object) -> None:
            pass

    def init(self: Any) -> None:
        if self._watcher is None:
            self._watcher = Watcher()

    unix._UnixDefaultEventLoopPolicy._init_watcher = init
