"""What `multiprocessing` shares between processes, for the threads of one: its semaphores, and the pipes of its queues.

No process is started by `multiprocessing` in simulated time, so that what it shares is shared by threads alone. All of its locks,
conditions, events and barriers are made of one semaphore of the system's, which waits in the scheduler here; whoever reads an empty pipe,
or writes into a full one, lets the others run.
"""

from __future__ import annotations

import _thread
import os
from collections import deque

from hrdsl import locks
from hrdsl.errors import Unsupported

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, NoReturn

    from hrdsl.schedule import Scheduler, Task

_get_ident = _thread.get_ident

#: The kinds of a semaphore, as the C code numbers them; the first is taken again by the thread that has it.
_RECURSIVE, _COUNTING = 0, 1

#: A pipe that is ready takes so many bytes without waiting (PIPE_BUF of Linux).
_AT_ONCE = 4096


class SharedSemaphore(locks._Waited):
    """A semaphore of `multiprocessing`: see `multiprocessing.synchronize.SemLock`. Who waits for longest gets it first."""

    __slots__ = ("kind", "maxvalue", "_value", "_taken")
    __module__, __qualname__ = "_multiprocessing", "SemLock"

    #: Set when `_multiprocessing` is imported.
    SEM_VALUE_MAX = 2**31 - 1

    name = None  # of a file, by which other processes find it
    handle = 0

    def __init__(self, kind: int, value: int, maxvalue: int, name: str, unlink: bool) -> None:
        if kind not in (_RECURSIVE, _COUNTING):
            raise ValueError("unrecognized kind")
        if not 0 <= value <= maxvalue:
            raise OSError(22, "Invalid argument")
        self.kind, self.maxvalue, self._value = kind, maxvalue, value
        self._owner: Any = None  # who has taken it last
        self._taken = 0  # so many times, less those that it was given back
        self._waiters = deque()

    @classmethod
    def _rebuild(cls, *args: Any) -> NoReturn:
        raise Unsupported(_NO_PROCESSES)

    def acquire(self, block: bool = True, timeout: float | None = None) -> bool:
        """Takes one of it, at most after so many seconds: whether that succeeded."""
        if self.kind == _RECURSIVE and self._is_mine():
            self._taken += 1
            return True
        if timeout is not None and not hasattr(timeout, "__float__"):
            raise TypeError("must be real number, not %s" % type(timeout).__name__)
        if self._try():
            return True
        if not block or timeout is not None and timeout <= 0:
            locks._s.polled("semaphore")
            return self._try()
        return self._wait(-1.0 if timeout is None else float(timeout))

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *exception: object) -> None:
        self.release()

    def release(self) -> None:
        """Gives one back."""
        if self.kind == _RECURSIVE:
            if not self._is_mine():
                raise AssertionError("attempt to release recursive lock not owned by thread")
            if self._taken > 1:
                self._taken -= 1
                return
        elif self._value >= self.maxvalue:
            raise ValueError("semaphore or lock released too many times")
        self._taken -= 1
        self._pass_on()

    def _try(self) -> bool:
        if not self._value:
            return False
        self._value -= 1
        self._owner = _get_ident()
        self._taken += 1
        return True

    def _give(self, task: Task) -> None:
        self._owner = task.ident
        self._taken += 1

    def _pass_on(self) -> None:
        self._value += 1
        while self._waiters:
            task = self._waiters.popleft()
            if not task.is_dead:
                self._value -= 1
                self._give(task)
                locks._s.unpark(task)
                return

    def _leave(self, me: Task) -> None:
        if me in self._waiters:
            self._waiters.remove(me)
        else:  # it was given just then
            self._taken -= 1
            self._pass_on()

    def _count(self) -> int:
        return self._taken

    def _is_mine(self) -> bool:
        return self._taken > 0 and bool(self._owner == _get_ident())

    def _get_value(self) -> int:
        locks._s.polled("semaphore")
        return self._value

    def _is_zero(self) -> bool:
        locks._s.polled("semaphore")
        return not self._value

    def _after_fork(self) -> None:
        self._taken = 0


_NO_PROCESSES = (
    "multiprocessing starts processes that run in real time, beside the simulated one; use threads"
    " (threading, concurrent.futures.ThreadPoolExecutor), or subprocess.run for a child that is waited for"
)


def patch_semaphores(module: Any, scheduler: Scheduler) -> None:
    """To be called when `_multiprocessing` is imported."""
    if hasattr(module, "SemLock"):
        SharedSemaphore.SEM_VALUE_MAX = module.SemLock.SEM_VALUE_MAX
        module.SemLock = SharedSemaphore


def patch_connections(module: Any, scheduler: Scheduler) -> None:
    """To be called when `multiprocessing.connection` is imported."""

    def _recv(self: Any, size: int, read: Any = os.read) -> Any:
        rest = size
        parts: list[bytes] = []
        while rest:
            _await(module, scheduler, self, False)
            part = read(self._handle, rest)
            if not part:
                raise OSError("got end of file during message") if parts else EOFError
            parts.append(part)
            rest -= len(part)
        buffer = module.io.BytesIO()
        buffer.write(b"".join(parts))
        return buffer

    def _send(self: Any, buf: Any, write: Any = os.write) -> None:
        rest = memoryview(buf)
        while rest:
            _await(module, scheduler, self, True)
            rest = rest[write(self._handle, rest[:_AT_ONCE]) :]

    module.Connection._recv, module.Connection._send = _recv, _send


def _await(module: Any, scheduler: Scheduler, connection: Any, writes: bool) -> None:
    """Waits until the connection has something to read, or room to write."""
    if scheduler.current() is not None:
        number = connection.fileno()
        import select

        select.select([] if writes else [number], [number] if writes else [], [])


def patch_starts(module: Any, scheduler: Scheduler) -> None:
    """To be called when `multiprocessing.process` is imported."""

    def start(self: Any) -> NoReturn:
        """Refused: it would run in real time beside the simulated one."""
        raise Unsupported(_NO_PROCESSES)

    module.BaseProcess.start = start
