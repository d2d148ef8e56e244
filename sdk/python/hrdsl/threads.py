"""Threads that the scheduler runs: what `_thread` has in the place of its own, and what is built on it.

It is replaced before the program imports `threading`, which takes these names from `_thread` at its import:

- in all versions: `allocate_lock`, `RLock`, `start_new_thread`;
- up to 3.12: `_set_sentinel`, a lock that is released when its thread has ended, by which threads are joined;
- from 3.13 on: `start_joinable_thread`, `_ThreadHandle`, `_make_thread_handle` and `_shutdown`, which join by handles.

When a thread has ended in Python, the system still tears down what belongs to it, such as the values of
`threading.local`. The next thread waits for that: up to 3.12 by a real sentinel, from 3.13 on by a real handle.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`
import _thread
import os
import sys

from hrdsl import locks
from hrdsl.errors import Busy, ChildLives, Deadlock, Stopped
from hrdsl.replace import Builtin, put, when_imported
from hrdsl.schedule import POLLS, Task

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.schedule import Scheduler

_real: Any = _thread  # without the names that versions lack
real_start = _thread.start_new_thread
real_start_joinable = getattr(_thread, "start_joinable_thread", None)
real_sentinel = getattr(_thread, "_set_sentinel", None)
_get_ident = _thread.get_ident


class Threads:
    """The threads of a scheduler, and the functions of `_thread`."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self.on_first: Callable[[], object] | None = None  # called before the program has a second thread

    def start(self, function: Callable[..., Any], args: Any, kwargs: Any, on_end: Any = None) -> Task:
        """Starts a thread, which runs when it is its turn."""
        if self.on_first is not None:
            self.on_first()
        task = Task(0)
        if on_end is not None:
            task.on_end.append(on_end)
        body = _Body(self._scheduler, task, function, args, kwargs)
        if real_start_joinable is None:
            task.ident = real_start(body, ())
        else:
            handle = real_start_joinable(body, daemon=True)
            task.ident, task.gone = handle.ident, handle.join
        self._scheduler.add(task)
        return task

    def start_new_thread(self, function: Any, args: Any, kwargs: Any = None) -> int:
        """As `_thread` has it."""
        if not callable(function):
            raise TypeError("first arg must be callable")
        if not isinstance(args, tuple):
            raise TypeError("2nd arg must be a tuple")
        if kwargs is not None and not isinstance(kwargs, dict):
            raise TypeError("optional 3rd arg must be a dictionary")
        return self.start(function, args, kwargs or {}).ident

    def set_sentinel(self) -> Any:
        """Of the thread that calls: a lock that is released at its end."""
        sentinel = locks.lock()
        task = self._scheduler.current()

        def release() -> None:
            if sentinel._owner is not None:
                sentinel.release()

        if task is not None:
            task.on_end.append(release)
        return sentinel

    def start_joinable_thread(self, function: Any, handle: Any = None, daemon: bool = True) -> ThreadHandle:
        """As `_thread` has it."""
        return self._start_joinable(function, handle, daemon)

    def _start_joinable(self, function: Any, given: Any, daemon: bool) -> ThreadHandle:
        if not callable(function):
            raise TypeError("thread function must be callable")
        if given is not None and not isinstance(given, ThreadHandle):
            raise TypeError("'handle' must be a _ThreadHandle")
        handle: ThreadHandle = given or ThreadHandle()
        if handle._state:
            raise RuntimeError("thread already started")
        handle._state = _STARTED
        handle._end.acquire()
        if not daemon:
            _joined.append(handle)
        try:
            task = self.start(function, (), {}, handle._set_done)
            handle.ident, handle._end._owner = task.ident, task
        except BaseException:
            handle._state = 0
            handle._set_done()
            raise
        return handle

    def make_thread_handle(self, ident: int) -> ThreadHandle:
        """Of a thread that runs, but was not started here."""
        handle = ThreadHandle()
        handle.ident, handle._state = ident, _STARTED
        handle._end.acquire()
        return handle

    def shutdown(self) -> None:
        """Waits for all threads that are no daemons."""
        while _joined:
            handle = _joined[-1]
            if handle.ident == _get_ident():
                _joined.remove(handle)
            else:
                handle.join()

    def count(self) -> int:
        """How many threads the program has started that have not ended."""
        return sum(task is not self._scheduler.main for task in self._scheduler.tasks.values())


class _Body:
    """What the system's thread calls. It is shown as the program's function where an exception is reported."""

    def __init__(
        self, scheduler: Scheduler, task: Task, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> None:
        self._parts: Any = (scheduler, task, function, args, kwargs)
        self._repr = repr(function)

    def __call__(self) -> None:
        scheduler, task, function, args, kwargs = self._parts
        if real_sentinel is not None:
            sentinel = real_sentinel()
            sentinel.acquire()
            task.gone = sentinel.acquire
        scheduler.begin(task)
        try:
            function(*args, **kwargs)
        finally:  # what it raises is reported while the next thread waits for this one to be gone
            self._parts = function = args = kwargs = None
            scheduler.finish(task)

    def __repr__(self) -> str:
        return self._repr


_STARTED, _DONE = 1, 2

#: The handles that `shutdown` waits for.
_joined: list[ThreadHandle] = []


class ThreadHandle:
    """A thread, as `threading` joins it from Python 3.13 on."""

    __module__, __qualname__ = "_thread", "_ThreadHandle"
    __slots__ = ("ident", "_state", "_end")

    def __init__(self) -> None:
        self.ident = 0
        self._state = 0
        self._end = locks.lock()  # released at its end

    def is_done(self) -> bool:
        """Whether the thread has ended."""
        if self._state != _DONE:
            locks._s.polled("thread")
        return self._state == _DONE

    def _set_done(self) -> None:
        if not self._state:
            raise RuntimeError("thread not started")
        self._state = _DONE
        if self in _joined:
            _joined.remove(self)
        if self._end._owner is not None:
            self._end.release()

    def join(self, timeout: float | None = None) -> None:
        """Waits until the thread has ended."""
        if not self._state:
            raise RuntimeError("thread not started")
        if self._state == _DONE:
            return
        if self.ident == _get_ident():
            raise RuntimeError("Cannot join current thread")
        if self._end.acquire(True, -1 if timeout is None or timeout < 0 else timeout):
            self._end.release()

    def __repr__(self) -> str:
        return "<_thread._ThreadHandle object: ident=%d>" % self.ident


def install(scheduler: Scheduler) -> Threads:
    """Replaces the threads and locks of this process; `threading` has not been imported yet, or is patched."""
    locks.use(scheduler)
    threads = Threads(scheduler)
    old = {name: getattr(_thread, name, None) for name in _NAMES}
    new = _replacements(threads)
    for name, value in new.items():
        if hasattr(_thread, name):
            setattr(_thread, name, value)
    threading = sys.modules.get("threading")
    if threading is not None:
        _mend(threading, old, new)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=scheduler.fork)
    _signals(scheduler)
    when_imported("threading", lambda module: _threading(module, scheduler))
    when_imported("_queue", _queue)
    when_imported("queue", lambda module: _poll_queues(module, scheduler))
    when_imported("concurrent.futures._base", _quiet_workers)
    return threads


_NAMES = (
    "allocate_lock", "allocate", "LockType", "lock", "RLock", "start_new_thread", "start_new", "_set_sentinel", "_count",
    "start_joinable_thread", "_ThreadHandle", "_make_thread_handle", "_shutdown",
)  # fmt: skip


def _replacements(threads: Threads) -> dict[str, Any]:
    def builtin(function: Callable[..., Any], name: str) -> Any:
        real = getattr(_real, name, None)
        return real and Builtin(function, real, "_thread")

    new: dict[str, Any] = dict.fromkeys(("allocate_lock", "allocate", "LockType", "lock"), locks.lock)
    new["RLock"] = locks.RLock
    new["start_new_thread"] = new["start_new"] = builtin(threads.start_new_thread, "start_new_thread")
    new["_set_sentinel"] = builtin(threads.set_sentinel, "_set_sentinel")
    new["_count"] = builtin(threads.count, "_count")
    new["start_joinable_thread"] = builtin(threads.start_joinable_thread, "start_joinable_thread")
    new["_ThreadHandle"] = ThreadHandle
    new["_make_thread_handle"] = builtin(threads.make_thread_handle, "_make_thread_handle")
    new["_shutdown"] = builtin(threads.shutdown, "_shutdown")
    return new


def _mend(threading: Any, old: dict[str, Any], new: dict[str, Any]) -> None:
    """`threading` was imported before, such as by `sitecustomize`, and no thread was started: it gets the names that it
    took, and locks in the place of those that it has made."""
    kinds = (type(locks.real_lock()), old["RLock"])
    for name, value in list(vars(threading).items()):
        for known, real in old.items():
            if value is real and real is not None:
                setattr(threading, name, new[known])
        if type(value) in kinds:
            setattr(threading, name, locks.lock() if type(value) is kinds[0] else locks.RLock())
    main = threading.main_thread()
    if hasattr(main, "_handle"):
        main._handle = new["_make_thread_handle"](main.ident)
    else:
        getattr(threading, "_shutdown_locks", set()).clear()
        main._set_tstate_lock()


def _threading(module: Any, scheduler: Scheduler) -> None:
    real_hook = module.excepthook

    def excepthook(args: Any, /) -> None:
        """Handle uncaught Thread.run() exception."""
        if not issubclass(args.exc_type, (Stopped, Deadlock, Busy, ChildLives)):  # which end threads as `SystemExit` does
            real_hook(args)

    module.excepthook = Builtin(excepthook, real_hook, "threading")

    def is_set(self: Any) -> bool:
        """Return true if and only if the internal flag is true."""
        scheduler.polls += 1
        if scheduler.polls >= POLLS:
            scheduler.much_polled()
        return bool(self._flag)

    module.Event.is_set = module.Event.isSet = is_set


def _signals(scheduler: Scheduler) -> None:
    def kill(pid: int, signal: int, /) -> None:
        real_kill(pid, signal)
        if pid == os.getpid():
            scheduler.signalled()

    def pthread_kill(ident: int, signal: int, /) -> None:
        real_pthread_kill(ident, signal)
        scheduler.signalled()

    def raise_signal(signal: int, /) -> None:
        real_raise(signal)
        scheduler.signalled()

    def interrupt_main(*signal: int) -> None:
        real_interrupt(*signal)
        scheduler.signalled()

    modules = [_signal] + [sys.modules[name] for name in ("signal",) if name in sys.modules]
    real_kill = put("kill", kill, os, *[module for module in map(sys.modules.get, ("posix", "nt")) if module])
    real_pthread_kill = put("pthread_kill", pthread_kill, *modules)
    real_raise = put("raise_signal", raise_signal, *modules)
    real_interrupt = put("interrupt_main", interrupt_main, _thread)


def _queue(module: Any) -> None:
    locks.SimpleQueue.Empty = module.Empty
    module.SimpleQueue = locks.SimpleQueue


def _quiet_workers(module: Any) -> None:
    """The workers of an executor log what ends them, which is no fault of theirs when it is the end of the test."""

    def is_fault(record: Any) -> bool:
        kind = record.exc_info[0] if record.exc_info else None
        return kind is None or not issubclass(kind, (Stopped, Deadlock, Busy, ChildLives))

    module.LOGGER.addFilter(is_fault)


def _poll_queues(module: Any, scheduler: Scheduler) -> None:
    """Asking a queue, and taking from an empty one without waiting, are polls."""

    def polling(real: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def ask(self: Any) -> Any:
            scheduler.polled("queue")
            return real(self)

        ask.__name__, ask.__qualname__, ask.__doc__ = real.__name__, real.__qualname__, real.__doc__
        return ask

    for name in ("empty", "full", "qsize"):
        setattr(module.Queue, name, polling(getattr(module.Queue, name)))

    real_get, real_put = module.Queue.get, module.Queue.put

    def get(self: Any, block: bool = True, timeout: float | None = None) -> Any:
        try:
            return real_get(self, block, timeout)
        except module.Empty:
            scheduler.polled("queue")
            raise

    def put(self: Any, item: Any, block: bool = True, timeout: float | None = None) -> None:
        try:
            real_put(self, item, block, timeout)
        except module.Full:
            scheduler.polled("queue")
            raise

    for function, real in ((get, real_get), (put, real_put)):
        function.__qualname__, function.__doc__ = real.__qualname__, real.__doc__
        setattr(module.Queue, function.__name__, function)
