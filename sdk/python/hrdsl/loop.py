"""The event loop of `asyncio` in simulated time.

It is the library's own loop for Unix, over a selector that waits in the scheduler: a loop without anything to do is a
thread that waits until its next timer, or until `call_soon_threadsafe` wakes it. Transports of sockets and pipes work; their
descriptors are asked whenever the loop has nothing else to do at an instant. Child processes are refused.
"""

from __future__ import annotations

import sys

from hrdsl.children import unsupported
from hrdsl.schedule import POLLS
from hrdsl.waits import Ready, wait

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, NoReturn

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
            # As `Scheduler.polled` does. The loop itself asks once in each turn: a coroutine that looks again and again, and sleeps for
            # nothing between, waits for time to pass, too.
            scheduler.polls += 1
            if scheduler.polls >= POLLS:
                scheduler.much_polled()
            return outside.time / 1e9

        # Signals alone need the pipe to itself that a loop has for being woken.

        def _make_self_pipe(self) -> None:
            self._ssock = self._csock = None

        def _close_self_pipe(self) -> None:
            if self._ssock is not None:
                super()._close_self_pipe()

        def _write_to_self(self) -> None:
            self._selector.wake()

        async def _make_subprocess_transport(self, *args: Any, **how: Any) -> NoReturn:
            raise unsupported("asyncio.create_subprocess_exec (or _shell)")

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

    class SelectorEventLoop(real):  # type: ignore[misc]
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
