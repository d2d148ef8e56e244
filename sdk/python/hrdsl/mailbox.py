"""A queue that handlers of the exchange fill, and threads empty."""

from __future__ import annotations

from collections import deque

from hrdsl.exchange import the_exchange

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class Mailbox:
    """Items in the order in which they were put. With a depth, the oldest are lost when there are more."""

    __slots__ = ("_exchange", "_items", "_waiters", "lost")

    def __init__(self, depth: int | None = None) -> None:
        self._exchange = the_exchange()
        self._items: deque[Any] = deque(maxlen=depth)
        self._waiters: deque[tuple[Any, list[Any]]] = deque()  # threads, and what they are given
        self.lost = 0

    def __len__(self) -> int:
        return len(self._items)

    def limit(self, depth: int | None) -> None:
        """Gives it another depth; of the items in it the newest stay."""
        if self._items.maxlen != depth:
            self._items = deque(self._items, maxlen=depth)

    def put(self, item: Any) -> None:
        """Puts an item in, or gives it to the thread that waits for longest; never waits."""
        while self._waiters:
            task, given = self._waiters.popleft()
            if task is None or not task.is_dead:
                given.append(item)
                if task is not None:
                    self._exchange.scheduler.unpark(task)
                return
        if len(self._items) == self._items.maxlen:
            self.lost += 1
        self._items.append(item)

    def get(self, timeout_ns: int | None = None) -> Any:
        """Takes the first item, or waits for one; None when the time is over, at whose very end an item still counts. Without
        any time it is a poll."""
        if self._items:
            return self._items.popleft()
        if timeout_ns is None:
            return self._wait(None)
        if timeout_ns > 0:
            return self._wait(self._exchange.time + timeout_ns)
        self._exchange.polled("mailbox")
        return self._items.popleft() if self._items else None

    def _wait(self, deadline: int | None) -> Any:
        exchange = self._exchange
        given: list[Any] = []
        waiter = (exchange.scheduler.current(), given)
        self._waiters.append(waiter)
        try:
            while not given:
                if not exchange.park(self, deadline) and not given:
                    break
        except BaseException:
            if given:
                self._items.appendleft(given.pop())
            raise
        finally:
            if waiter in self._waiters:
                self._waiters.remove(waiter)
        return given.pop() if given else None
