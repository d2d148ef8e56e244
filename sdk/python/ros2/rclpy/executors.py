"""Executors: which callback runs next, and in which thread.

What is ready runs node by node in the order in which nodes were added, in a node timers first, then subscriptions, guard
conditions, clients and services, each in the order in which they were made; actions come before all of these. Then it is
asked again what is ready.
"""

from __future__ import annotations

import _thread

from rclpy import _failures, _world
from rclpy._bell import Bell
from rclpy.task import Task, is_coroutine_function
from rclpy.utilities import get_default_context, timeout_sec_to_nsec

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterator

    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.task import Future

    Work = tuple[Task, Any, Any]  # a task, what it is about, and whose that is


_failures.watch_threads()


async def await_or_execute(callback: Any, *args: Any) -> Any:
    """Awaits a coroutine function, calls any other."""
    if is_coroutine_function(callback):
        return await callback(*args)
    return callback(*args)


class TimeoutException(Exception):
    """The time is over."""


class ShutdownException(Exception):
    """The executor has been shut down."""


class ExternalShutdownException(Exception):
    """The context has been shut down."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)


class ConditionReachedException(Exception):
    """What was waited for is there."""


class TimeoutObject:
    """A timeout that becomes less without being another one."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


def _never() -> bool:
    return False


class Executor:
    """The base of executors. One of a program's own defines `spin_once`, which gets work from `wait_for_ready_callbacks`."""

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = get_default_context() if context is None else context
        self._nodes: dict[Node, None] = {}
        self._tasks: list[Work] = []
        self._bell = Bell()
        self._is_shutdown = False
        self._working: list[int] = []  # the threads that run callbacks
        self._iterator: Iterator[Work] | None = None
        self._asked: Any = None  # with what the iterator was made
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        """The context that ends it."""
        return self._context

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Runs a function or a coroutine when the executor spins; its result is that of the task."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append((task, None, None))
        self._bell.ring()
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Runs no more callbacks, and waits for those that other threads run: whether they have ended."""
        self._is_shutdown = True
        self._bell.ring()
        nanos = timeout_sec_to_nsec(timeout_sec)
        deadline = None if nanos < 0 else _world.now() + nanos
        me = _thread.get_ident()
        while any(ident != me for ident in self._working):
            self._bell.is_rung = False
            if not self._bell.wait(deadline):
                return False
        self._nodes = {}
        self._iterator = None
        return True

    def add_node(self, node: Node) -> bool:
        """Runs the node's callbacks from now on; False if it did."""
        if node in self._nodes:
            return False
        self._nodes[node] = None
        node.executor = self
        self._bell.ring()
        return True

    def remove_node(self, node: Node) -> None:
        """Does not any more."""
        if node in self._nodes:
            del self._nodes[node]
            self._bell.ring()

    def wake(self) -> None:
        """Something has changed."""
        self._bell.ring()

    def get_nodes(self) -> list[Node]:
        """The nodes whose callbacks it runs."""
        return list(self._nodes)

    # ── spinning ──

    def spin(self) -> None:
        """Runs callbacks until the context or the executor is shut down."""
        while self._context.is_open() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Runs callbacks until the future is done, or for so long."""
        future.add_done_callback(lambda _: self.wake())
        if timeout_sec is None or timeout_sec < 0:
            while self._context.is_open() and not future._done and not self._is_shutdown:
                self.spin_once_until_future_complete(future, timeout_sec)
            return
        end = _world.now() + round(timeout_sec * 1e9)
        left = TimeoutObject(timeout_sec)
        while self._context.is_open() and not future._done and not self._is_shutdown:
            self.spin_once_until_future_complete(future, left)
            now = _world.now()
            if now >= end:
                return
            left.timeout = (end - now) / 1e9

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Runs one callback, or waits until the timeout."""
        raise NotImplementedError()

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        """The same, but waits for no callback when the future is done."""
        raise NotImplementedError()

    # ── work ──

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Work:
        """The next work: a task to be called, what it is about, and whose that is. Raises TimeoutException and
        ShutdownException; takes `timeout_sec`, `nodes` and `condition`."""
        while True:
            if self._iterator is None or self._asked != (args, kwargs):
                self._asked = (args, kwargs)
                self._iterator = self._wait_for_ready_callbacks(*args, **kwargs)
            try:
                return next(self._iterator)
            except StopIteration:
                self._iterator = None

    def _wait_for_ready_callbacks(
        self, timeout_sec: Any = None, nodes: list[Node] | None = None, condition: Callable[[], bool] = _never
    ) -> Iterator[Work]:
        nanos = timeout_sec_to_nsec(timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec)
        deadline = None if nanos < 0 else _world.now() + nanos
        found = False
        while not (found or self._is_shutdown or condition()):
            self._bell.is_rung = False
            chosen = self.get_nodes() if nodes is None else nodes
            if self._tasks:
                for task, entity, node in _world.in_turn(self._tasks[::-1]):
                    if task._can_go_on() and (node is None or node in chosen):
                        found = True
                        yield task, entity, node
                self._tasks = [work for work in self._tasks if not work[0]._done]
            ready = self._scan(chosen)
            if not ready:
                self._sleep(chosen, deadline, nanos)
                ready = self._scan(chosen)
            _world.in_turn(ready)
            if self._is_shutdown:
                raise ShutdownException()
            if not self._context.is_open():
                raise ExternalShutdownException()
            is_late = deadline is not None and _world.now() >= deadline
            for entity, node in ready:
                if self._is_ready(entity, _world.now()):
                    found = True
                    yield self._make_handler(entity, node), entity, node
            if is_late:
                raise TimeoutException()
        if self._is_shutdown:
            raise ShutdownException()
        if condition():
            raise ConditionReachedException()

    def _scan(self, nodes: list[Node]) -> list[tuple[Any, Node]]:
        """What is ready now, in its order."""
        now = _world.now()
        ready = []
        for node in nodes:
            for entity in node._waitables_:
                if self._is_ready(entity, now):
                    ready.append((entity, node))
        for node in nodes:
            for entities in (node._timers, node._subscriptions, node._guards, node._clients, node._services):
                for entity in entities:
                    if entity._is_ready(now) and self._is_ready(entity, now):
                        ready.append((entity, node))
        return ready

    def can_execute(self, entity: Any) -> bool:
        """Whether its callback could run now, if it is ready."""
        return not entity._executor_event and bool(entity.callback_group.can_execute(entity))

    def _is_ready(self, entity: Any, now: int) -> bool:
        return not entity._is_destroyed and self.can_execute(entity) and bool(entity._is_ready(now))

    def _sleep(self, nodes: list[Node], deadline: int | None, nanos: int) -> None:
        """Waits until something may be ready, or until the deadline."""
        if nanos == 0:
            _world.looked("spin_once")
            return
        for node in nodes:
            for timer in node._timers:
                if not timer._is_canceled and (deadline is None or timer._next < deadline) and self.can_execute(timer):
                    deadline = timer._next
        quiet = [each for node in nodes for each in node._waitables_ if each._due is not None and self.can_execute(each)]
        if quiet:
            deadline = min(each._due for each in quiet)
        if not self._bell.wait(deadline):
            for each in quiet:
                each._is_quiet = True

    def _make_handler(self, entity: Any, node: Node) -> Task:
        entity._executor_event = True
        is_async = getattr(entity, "_is_async", None)
        if is_coroutine_function(entity.callback) if is_async is None else is_async():
            task = Task(self._run_async, (entity, node), executor=self)
        else:
            task = Task(self._run, (entity, node), executor=self)
        self._tasks.append((task, entity, node))
        return task

    def _begin(self, entity: Any) -> bool:
        if self._is_shutdown or not entity.callback_group.beginning_execution(entity):
            entity._executor_event = False
            self._bell.ring()
            return False
        self._working.append(_thread.get_ident())
        return True

    def _take(self, entity: Any) -> Any:
        try:
            return None if entity._is_destroyed else entity._take()
        finally:
            entity._executor_event = False
            self._bell.ring()

    def _end(self, entity: Any, ident: int) -> None:
        entity.callback_group.ending_execution(entity)
        self._working.remove(ident)
        self._bell.ring()

    def _run(self, entity: Any, node: Node) -> None:
        if not self._begin(entity):
            return
        try:
            taken = self._take(entity)
            if taken is not None:
                taken[0](*taken[1])
        except Exception as error:
            _failures.keep(error, node, entity)
            raise
        finally:
            self._end(entity, _thread.get_ident())

    async def _run_async(self, entity: Any, node: Node) -> None:
        if not self._begin(entity):
            return
        ident = _thread.get_ident()
        try:
            taken = self._take(entity)
            if taken is not None:
                await taken[0](*taken[1])
        except Exception as error:
            _failures.keep(error, node, entity)
            raise
        finally:
            self._end(entity, ident)

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *of_exception: object) -> None:
        self.shutdown()


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins, one after the other."""

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Runs one callback, or waits until the timeout."""
        self._spin_once(timeout_sec, _never)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        """The same, but waits for no callback when the future is done."""
        self._spin_once(timeout_sec, future.done)

    def _spin_once(self, timeout_sec: Any, condition: Callable[[], bool]) -> None:
        try:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, condition)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        handler()
        error = handler.exception()
        if error is not None:
            _failures.leave(error)
            raise error


class MultiThreadedExecutor(Executor):
    """Runs callbacks in a pool of threads: four, unless it is told how many."""

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        from rclpy._pool import Pool

        self._futures: list[Task] = []
        self._executor = Pool(4 if num_threads is None else num_threads)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Lets one callback run, or waits until the timeout."""
        self._spin_once(timeout_sec, _never)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        """The same, but waits for no callback when the future is done."""
        self._spin_once(timeout_sec, future.done)

    def _spin_once(self, timeout_sec: Any, condition: Callable[[], bool]) -> None:
        try:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, condition)
        except (ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException):
            return
        handler._is_queued = True
        self._executor.submit(handler)
        self._futures.append(handler)
        for future in self._futures[:]:
            if future._done:
                self._futures.remove(future)
                error = future.exception()
                if error is not None:
                    _failures.leave(error)
                    raise error
