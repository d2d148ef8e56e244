"""The locks of `_thread`, and the queue of `_queue`, for threads that the scheduler runs.

All other means of `threading`, `queue` and `concurrent.futures` are made of these. Since one thread runs at a time, an
attribute is enough to lock; what must wait is in lists of the scheduler's tasks. A lock that is released goes to the one
that waits for longest, and so cannot be taken again before that.
"""

from __future__ import annotations

import _thread
import time
from collections import deque

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

    from hrdsl.schedule import Scheduler, Task

_get_ident = _thread.get_ident
real_lock = _thread.allocate_lock
real_sleep = time.sleep

_s: Scheduler


def use(scheduler: Scheduler) -> None:
    """Lets this scheduler run those who wait."""
    global _s
    _s = scheduler


def _check(blocking: Any, timeout: Any) -> None:
    # A real lock says what is wrong in the words of its version of Python.
    real_lock().acquire(blocking, timeout)


def after(timeout: float) -> int:
    """The deadline of a wait that lasts so many seconds. What is left of a timeout after some waits may be less than a nanosecond, and
    whoever waits for that would come again and again while no time passes."""
    return _s.outside.time + (max(1, round(timeout * 1e9)) if timeout > 0 else 0)


def _poll(try_: Callable[[], bool], timeout: float) -> bool:
    """How threads wait that the scheduler does not run, such as those started by code in C: in real time."""
    waited = 0.0
    while not try_():
        if 0 <= timeout <= waited:
            return False
        real_sleep(0.001)
        waited += 0.001
    return True


class _Waited:
    """What a lock of either kind does when it is taken."""

    __slots__ = ("_owner", "_waiters", "__weakref__")

    _owner: Any
    _waiters: Any

    def _wait(self, timeout: float) -> bool:
        """Waits until it is given to this thread; below zero without an end."""
        me = _s.running
        if me.ident != _get_ident() or me.result is None:
            known = _s.current()
            if known is None:
                return _poll(self._try, timeout)
            me = known
            if self._try():  # the others have run meanwhile
                return True
        if self._waiters is None:
            self._waiters = deque()
        self._waiters.append(me)
        try:
            given = _s.park(self, None if timeout < 0 else after(timeout))
        except BaseException:
            self._leave(me)
            raise
        if not given:
            self._leave(me)
        return given

    def _leave(self, me: Task) -> None:
        if me in self._waiters:
            self._waiters.remove(me)
        else:  # it was given just then
            self._pass_on()

    def _pass_on(self) -> None:
        waiters = self._waiters
        while waiters:
            task = waiters.popleft()
            if not task.is_dead:
                self._give(task)
                _s.unpark(task)
                return
        self._owner = None

    def _give(self, task: Task) -> None:
        raise NotImplementedError

    def _try(self) -> bool:
        raise NotImplementedError

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("cannot pickle '%s' object" % _name(self))


def _name(value: object) -> str:
    return "%s.%s" % (type(value).__module__, type(value).__qualname__)


class lock(_Waited):
    """A lock object is a synchronization primitive: see `threading.Lock`."""

    __slots__ = ()
    __module__ = "_thread"

    def __init__(self) -> None:
        self._owner = self._waiters = None

    def __init_subclass__(cls) -> None:
        raise TypeError("type '_thread.lock' is not an acceptable base type")

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Locks: whether that succeeded."""
        if self._owner is None and timeout == -1:
            self._owner = _s.running
            return True
        if timeout == -1 and blocking is True:
            return self._wait(-1)
        if timeout != -1 or blocking is not False:
            _check(blocking, timeout)
        if not blocking or timeout == 0:
            if self._owner is not None:
                _s.polled("lock")
            return self._try()
        return self._try() or self._wait(timeout)

    def __enter__(self) -> bool:
        if self._owner is None:
            self._owner = _s.running
            return True
        return self._wait(-1)

    def __exit__(self, *exception: object) -> None:
        if self._waiters or self._owner is None:
            self.release()
        else:
            self._owner = None

    def release(self) -> None:
        """Unlocks; any thread may do that."""
        if self._owner is None:
            raise RuntimeError("release unlocked lock")
        if self._waiters:
            self._pass_on()
        else:
            self._owner = None

    def locked(self) -> bool:
        """Whether somebody has it."""
        _s.polled("lock")
        return self._owner is not None

    def _try(self) -> bool:
        if self._owner is None:
            self._owner = _s.running
            return True
        return False

    def _give(self, task: Task) -> None:
        self._owner = task

    def _at_fork_reinit(self) -> None:
        self._owner = self._waiters = None

    def _is_owned(self) -> bool:
        # What `Condition` asks; it would try to take the lock otherwise.
        return self._owner is not None

    acquire_lock, release_lock, locked_lock = acquire, release, locked

    def __repr__(self) -> str:
        state = "unlocked" if self._owner is None else "locked"
        return "<%s %s object at %s>" % (state, _name(self), hex(id(self)))


class RLock(_Waited):
    """A lock that its owner can take again: see `threading.RLock`."""

    __slots__ = ("_count",)
    __module__ = "_thread"

    _count: int

    def __new__(cls, *args: Any, **kwargs: Any) -> RLock:
        self = super().__new__(cls)
        self._owner = self._waiters = None
        self._count = 0
        return self

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        pass

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Locks: whether that succeeded."""
        if timeout == -1:
            me = _get_ident()
            if self._owner is None:
                self._owner = me
                self._count = 1
                return True
            if self._owner == me:
                self._count += 1
                return True
            if blocking is True:
                return self._wait(-1)
        if timeout != -1 or blocking is not False:
            _check(blocking, timeout)
        if not blocking or timeout == 0:
            if self._owner not in (None, _get_ident()):
                _s.polled("lock")
            return self._try()
        return self._try() or self._wait(timeout)

    def __enter__(self) -> bool:
        me = _get_ident()
        if self._owner is None:
            self._owner = me
            self._count = 1
            return True
        if self._owner == me:
            self._count += 1
            return True
        return self._wait(-1)

    def release(self) -> None:
        """Unlocks once; only its owner may do that."""
        if self._owner != _get_ident():
            raise RuntimeError("cannot release un-acquired lock")
        self._count -= 1
        if not self._count:
            if self._waiters:
                self._pass_on()
            else:
                self._owner = None

    def __exit__(self, *exception: object) -> None:
        if self._count == 1 and not self._waiters and self._owner == _get_ident():
            self._count = 0
            self._owner = None
        else:
            self.release()

    def _try(self) -> bool:
        me = _get_ident()
        if self._owner not in (None, me):
            return False
        self._count = 1 if self._owner is None else self._count + 1
        self._owner = me
        return True

    def _give(self, task: Task) -> None:
        self._owner, self._count = task.ident, 1

    def _pass_on(self) -> None:
        self._count = 0
        super()._pass_on()

    def _is_owned(self) -> bool:
        return bool(self._owner == _get_ident())

    def _recursion_count(self) -> int:
        return self._count if self._is_owned() else 0

    def _release_save(self) -> tuple[int, int]:
        if not self._count:
            raise RuntimeError("cannot release un-acquired lock")
        state = (self._count, self._owner)
        self._pass_on()
        return state

    def _acquire_restore(self, state: tuple[int, int]) -> None:
        if not self._try():
            self._wait(-1)
        self._count, self._owner = state

    def _at_fork_reinit(self) -> None:
        self._owner = self._waiters = None
        self._count = 0

    def __repr__(self) -> str:
        state = "locked" if self._count else "unlocked"
        told = state, _name(self), self._owner or 0, self._count, hex(id(self))
        return "<%s %s object owner=%s count=%s at %s>" % told


class SimpleQueue:
    """A queue without an end: see `queue.SimpleQueue`."""

    __slots__ = ("_items", "_waiters", "__weakref__")
    __module__ = "_queue"

    _items: deque[Any]
    _waiters: deque[tuple[Task, list[Any]]]

    #: Set when `_queue` is imported.
    Empty: type[Exception]

    def __new__(cls, *args: Any, **kwargs: Any) -> SimpleQueue:
        self = super().__new__(cls)
        self._items = deque()
        self._waiters = deque()
        return self

    @classmethod
    def __class_getitem__(cls, item: Any) -> Any:
        from types import GenericAlias

        return GenericAlias(cls, item)

    def put(self, item: Any, block: bool = True, timeout: float | None = None) -> None:
        """Puts an item at the end; the arguments after it are there for likeness alone."""
        while self._waiters:
            task, given = self._waiters.popleft()
            if not task.is_dead:
                given.append(item)
                _s.unpark(task)
                return
        self._items.append(item)

    def put_nowait(self, item: Any) -> None:
        """As `put`."""
        self.put(item)

    def get(self, block: bool = True, timeout: float | None = None) -> Any:
        """Takes the first item, or waits for one; raises `Empty` after the timeout."""
        if block and timeout is not None and timeout < 0:
            raise ValueError("'timeout' must be a non-negative number")
        if self._items:
            return self._items.popleft()
        if not block or timeout == 0:
            _s.polled("queue")
            if self._items:
                return self._items.popleft()
            raise self.Empty
        return self._wait(-1 if timeout is None else timeout)

    def _wait(self, timeout: float) -> Any:
        me = _s.current()
        if me is None:
            if _poll(lambda: bool(self._items), timeout):
                return self._items.popleft()
            raise self.Empty
        given: list[Any] = []
        waiter = (me, given)
        self._waiters.append(waiter)
        try:
            _s.park(self, None if timeout < 0 else after(timeout))
        except BaseException:
            if given:
                self._items.appendleft(given.pop())
            raise
        finally:
            if waiter in self._waiters:
                self._waiters.remove(waiter)
        if given:
            return given.pop()
        raise self.Empty

    def get_nowait(self) -> Any:
        """Takes the first item; raises `Empty` if there is none."""
        return self.get(False)

    def empty(self) -> bool:
        """Whether there is no item."""
        _s.polled("queue")
        return not self._items

    def qsize(self) -> int:
        """How many items there are."""
        _s.polled("queue")
        return len(self._items)

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("cannot pickle '%s' object" % _name(self))

    def __repr__(self) -> str:
        return "<%s object at %s>" % (_name(self), hex(id(self)))
