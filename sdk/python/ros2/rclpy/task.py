"""Futures, and tasks that an executor runs."""

from __future__ import annotations

import _thread
import sys
import threading
from functools import partial
from types import CodeType, CoroutineType, MethodType
from weakref import ref

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Generator

_IS_COROUTINE = 0x80  # as `inspect.CO_COROUTINE`, whose module takes long to import


def is_coroutine_function(function: Any) -> bool:
    """Whether a call of it makes a coroutine."""
    while isinstance(function, (partial, MethodType)):
        function = function.func if isinstance(function, partial) else function.__func__
    code = getattr(function, "__code__", None)
    return isinstance(code, CodeType) and bool(code.co_flags & _IS_COROUTINE)


def _running_loop() -> Any:
    """The loop of `asyncio` that runs in this thread, or None."""
    events: Any = sys.modules.get("asyncio.events")
    return None if events is None else events._get_running_loop()


#: By threads in which an executor runs a coroutine: the loop of `asyncio` around that, or None.
_stepping: dict[int, Any] = {}


class Future:
    """What will be known later."""

    def __init__(self, *, executor: Any = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[Callable[[Future], Any]] = []
        self._wakes: list[Callable[[], Any]] = []  # executors with a task that awaits it
        self._lock = threading.Lock()
        self._executor: Callable[[], Any] | None = None
        self._set_executor(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            print("The following exception was never retrieved: %s" % self._exception, file=sys.stderr)

    def __await__(self) -> Generator[Any, None, Any]:
        if not self._done:
            loop = _running_loop()
            if loop is not None and loop is not _stepping.get(_thread.get_ident()):
                yield from self._turn(loop)
        while not self._done:
            yield self
        return self.result()

    def _turn(self, loop: Any) -> Any:
        """Lets a coroutine that a loop of `asyncio` runs wait, whichever thread sets the result."""
        turn = loop.create_future()

        def end() -> None:
            if not turn.done():
                turn.set_result(None)

        def wake() -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(end)

        self._wakes.append(wake)
        return turn.__await__()

    def cancel(self) -> None:
        """Asks for the work not to be done, if it is not done yet."""
        if not self._done:
            self._cancelled = True
        self._invoke_callbacks()

    def cancelled(self) -> bool:
        """Whether that was asked for."""
        return self._cancelled

    def done(self) -> bool:
        """Whether there is a result, or an exception."""
        if not self._done:
            from rclpy import _world

            _world.looked("Future.done")
        return self._done

    def result(self) -> Any:
        """The result, or None as long as there is none; raises the exception if that is it."""
        if self._exception is not None:
            raise self.exception()  # type: ignore[misc]
        return self._result

    def exception(self) -> BaseException | None:
        """The exception, if there is one."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        """It is known now."""
        self._result = result
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        """It has failed."""
        self._exception = exception
        self._exception_fetched = False
        self._finish()

    def _finish(self) -> None:
        self._done = True
        self._cancelled = False
        self._invoke_callbacks()
        wakes, self._wakes = self._wakes, []
        for wake in wakes:
            wake()

    def _own_executor(self) -> Any:
        return None if self._executor is None else self._executor()

    def _invoke_callbacks(self) -> None:
        executor = self._own_executor()
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:  # there may be more callbacks
                import warnings

                warnings.warn("Unhandled exception in done callback: %s" % error, stacklevel=2)

    def _set_executor(self, executor: Any) -> None:
        self._executor = None if executor is None else ref(executor)

    def add_done_callback(self, callback: Callable[[Future], Any]) -> None:
        """Calls it with the future when that is done, in its executor if it has one; at once if it is done."""
        if not self._done:
            self._callbacks.append(callback)
            return
        executor = self._own_executor()
        if executor is not None:
            executor.create_task(callback, self)
        else:
            callback(self)

    def remove_done_callback(self, callback: Callable[[Future], Any]) -> bool:
        """It is not called any more: whether it would have been."""
        if callback not in self._callbacks:
            return False
        self._callbacks.remove(callback)
        return True


class Task(Future):
    """A function or a coroutine that an executor runs to its end."""

    def __init__(self, handler: Any, args: Any = None, kwargs: Any = None, executor: Any = None) -> None:
        super().__init__(executor=executor)
        self._handler = handler
        self._args = () if args is None else args
        self._kwargs = {} if kwargs is None else kwargs
        if is_coroutine_function(handler):
            self._handler = handler(*self._args, **self._kwargs)
        self._executing = False
        self._awaits: Future | None = None
        self._is_queued = False  # in a pool of threads

    def __call__(self) -> None:
        """Runs it, or goes on with it."""
        self._is_queued = False
        if self._done or self._executing:
            return
        self._executing = True
        try:
            if isinstance(self._handler, CoroutineType):
                self._step(self._handler)
            else:
                self._run()
        finally:
            self._executing = False

    def _step(self, coroutine: Any) -> None:
        self._awaits = None
        ident = _thread.get_ident()
        outer = _stepping.get(ident)
        _stepping[ident] = _running_loop()
        try:
            awaited = coroutine.send(None)
        except StopIteration as end:
            self.set_result(end.value)
        except Exception as error:
            self.set_exception(error)
        else:
            executor = self._own_executor()
            if isinstance(awaited, Future) and executor is not None:
                self._awaits = awaited
                awaited._wakes.append(executor.wake)
            return
        finally:
            _stepping[ident] = outer
        self._handler = None

    def _run(self) -> None:
        try:
            result = self._handler(*self._args, **self._kwargs)
        except Exception as error:
            self.set_exception(error)
        else:
            self.set_result(result)
        self._handler = None
        self._args = self._kwargs = None

    def executing(self) -> bool:
        """Whether it is running right now."""
        return self._executing

    def _can_go_on(self) -> bool:
        """Whether running it now could do anything."""
        return not (self._done or self._executing or self._is_queued) and (self._awaits is None or self._awaits._done)
