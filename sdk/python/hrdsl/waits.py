"""Waits for descriptors.

`select`, `poll` and `epoll` wait in simulated time: at each instant at which all threads wait, the descriptors are asked
before time moves. Where nothing in the program has a deadline, the descriptors alone can end the wait, and the system's
real time passes.
"""

from __future__ import annotations

from hrdsl import children, processes
from hrdsl.locks import after
from hrdsl.replace import Builtin

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.schedule import Scheduler, Watch


class Ready:
    """A wait for whatever a function finds that asks without waiting; `masks` are its descriptors."""

    def __init__(self, ask: Callable[[], Any], masks: Callable[[], list[tuple[int, int]]]) -> None:
        self._ask = ask
        self.descriptors = masks
        self.found: Any = None

    def look(self) -> bool:
        """Asks."""
        self.found = self._ask()
        return any(self.found) if isinstance(self.found, tuple) else bool(self.found)


def wait(scheduler: Scheduler, watch: Watch, timeout: float | None) -> bool:
    """Waits until the watch has found something, at most so many seconds; no time at all is a poll. False at once if the
    scheduler does not run the thread that calls, which is to wait by itself then."""
    me = scheduler.current()
    if me is None:
        return False
    if scheduler.children:  # whose pipes would be ready sooner or later in real time
        scheduler.refuse_wait()
    if watch.look():
        return True
    if timeout is not None and timeout <= 0:
        scheduler.polled("descriptors")
        watch.look()
        return True
    scheduler.watched[me] = watch
    try:
        scheduler.park(watch, None if timeout is None else after(timeout))
    finally:
        del scheduler.watched[me]
    watch.look()
    return True


def _descriptors(module: Any, scheduler: Scheduler) -> None:
    real, real_poll = module.select, getattr(module, "poll", None)

    def select(rlist: Any, wlist: Any, xlist: Any, timeout: float | None = None, /) -> Any:
        try:
            is_wrong = timeout is not None and timeout < 0
        except TypeError:
            is_wrong = True
        if is_wrong:
            return real(rlist, wlist, xlist, timeout)  # which says so
        lists = [list(each) for each in (rlist, wlist, xlist)]
        watch = Ready(lambda: real(*lists, 0), lambda: _masks(lists))
        return watch.found if wait(scheduler, watch, timeout) else real(*lists, timeout)

    module.select = Builtin(select, real, "select")
    if real_poll is None:
        return
    module.poll = _poll(real_poll, scheduler)
    as_they_were["poll"] = real_poll
    scheduler.look = lambda block: _look(scheduler, real_poll, block)
    if hasattr(module, "epoll"):
        module.epoll = _epoll(module.epoll, scheduler)


#: What others need as it was.
as_they_were: dict[str, Any] = {}

_IN, _PRI, _OUT = 1, 2, 4  # POLLIN, POLLPRI, POLLOUT


def _masks(lists: list[list[Any]]) -> list[tuple[int, int]]:
    masks: dict[int, int] = {}
    for bit, files in zip((_IN, _OUT, _PRI), lists):
        for file in files:
            number = file if isinstance(file, int) else file.fileno()
            masks[number] = masks.get(number, 0) | bit
    return list(masks.items())


def _look(scheduler: Scheduler, real_poll: Callable[[], Any], block: bool) -> bool:
    """Makes those ready whose descriptors are, in the order in which they have begun to wait. With `block` waits for one
    of these in real time; False if that is no use."""
    found = False
    for task, watch in list(scheduler.watched.items()):
        if task.result is None and watch.look():
            scheduler.unpark(task)
            found = True
    if found or not block:
        return found
    masks: dict[int, int] = {}
    for watch in scheduler.watched.values():
        for number, mask in watch.descriptors():
            masks[number] = masks.get(number, 0) | mask
    if not masks:
        return False
    every = real_poll()
    for number, mask in masks.items():
        every.register(number, mask)
    every.poll()
    return True


def _poll(real_poll: Callable[[], Any], scheduler: Scheduler) -> Any:
    class poll:
        """Returns a polling object: see `select.poll`."""

        def __init__(self) -> None:
            self._real = real_poll()
            self._masks: dict[int, int] = {}

        def register(self, fd: Any, eventmask: int = _IN | _PRI | _OUT, /) -> None:
            self._real.register(fd, eventmask)
            self._masks[_number(fd)] = eventmask

        def modify(self, fd: Any, eventmask: int, /) -> None:
            self._real.modify(fd, eventmask)
            self._masks[_number(fd)] = eventmask

        def unregister(self, fd: Any, /) -> None:
            self._real.unregister(fd)
            self._masks.pop(_number(fd), None)

        def poll(self, timeout: float | None = None, /) -> Any:
            """Waits for so many milliseconds; below zero, and with None, for ever."""
            watch = Ready(lambda: self._real.poll(0), lambda: list(self._masks.items()))
            seconds = None if timeout is None or timeout < 0 else timeout / 1000
            return watch.found if wait(scheduler, watch, seconds) else self._real.poll(timeout)

    poll.__module__, poll.__qualname__ = "select", "poll"
    return poll


def _number(file: Any) -> int:
    number: int = file if isinstance(file, int) else file.fileno()
    return number


def _epoll(real_epoll: Any, scheduler: Scheduler) -> Any:
    class epoll:
        """Returns an epolling object: see `select.epoll`."""

        def __init__(self, sizehint: int = -1, flags: int = 0) -> None:
            self._real = real_epoll(sizehint, flags)

        @classmethod
        def fromfd(cls, fd: int, /) -> epoll:
            self = cls.__new__(cls)
            self._real = real_epoll.fromfd(fd)
            return self

        def poll(self, timeout: float | None = None, maxevents: int = -1) -> Any:
            """Waits for so many seconds; below zero, and with None, for ever."""
            watch = Ready(lambda: self._real.poll(0, maxevents), lambda: [(self._real.fileno(), _IN)])
            seconds = None if timeout is None or timeout < 0 else timeout
            return watch.found if wait(scheduler, watch, seconds) else self._real.poll(timeout, maxevents)

        def __enter__(self) -> epoll:
            self._real.__enter__()
            return self

        def __exit__(self, *exception: object) -> None:
            self._real.close()

        def __getattr__(self, name: str) -> Any:
            return getattr(self._real, name)

    epoll.__module__, epoll.__qualname__ = "select", "epoll"
    return epoll


def _asyncio(module: Any, scheduler: Scheduler) -> None:
    from hrdsl import loop

    loop.install(module, scheduler)


#: What patches each module that waits in ways of its own.
PATCHES: dict[str, Callable[[Any, Scheduler], None]] = {
    "select": _descriptors,
    "subprocess": children.patch_subprocess,
    "_multiprocessing": processes.patch_semaphores,
    "multiprocessing.connection": processes.patch_connections,
    "multiprocessing.process": processes.patch_starts,
    "asyncio": _asyncio,
}
