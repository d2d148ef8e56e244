"""The deadlines of threads that wait, the first of them first."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.schedule import Task


#: `_heapq`, which programs do without that never wait for a time.
_heap: Any = None


class Deadlines:
    """A heap in which a deadline is valid for as long as its thread has the ticket that was written beside it."""

    __slots__ = ("entries",)

    def __init__(self) -> None:
        self.entries: list[tuple[int, int, Task]] = []

    def push(self, deadline: int, task: Task) -> None:
        """The thread has just got its ticket."""
        global _heap
        if _heap is None:
            import _heapq as _heap
        _heap.heappush(self.entries, (deadline, task.ticket, task))

    def first(self) -> int | None:
        """The first of those who still wait."""
        entries = self.entries
        while entries and entries[0][2].ticket != entries[0][1]:
            _heap.heappop(entries)
        return entries[0][0] if entries else None

    def expire(self, time: int, tell: Callable[[Task, bool], object], tasks: int) -> None:
        """Tells the threads whose deadlines have come; now and then, forgets those that are not valid any more."""
        entries = self.entries
        while entries and entries[0][0] <= time:
            _, ticket, task = _heap.heappop(entries)
            if task.ticket == ticket:
                tell(task, False)
        if len(entries) > 64 + 4 * tasks:
            self.entries = [entry for entry in entries if entry[2].ticket == entry[1]]
            _heap.heapify(self.entries)
