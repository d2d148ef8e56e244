"""The events that the program's actor has heard, until they are taken or dropped."""

from __future__ import annotations

from collections import deque

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Iterable

    from hrdsl.exchange import Exchange

#: So many events are kept; of more, the oldest are lost.
KEPT = 1000


class Ending:
    """Something that ends, such as a motion, and that can be waited for beside events."""

    def __init__(self) -> None:
        self._place = 0  # among all that has arrived; 0: it has not ended


class _Hearer:
    """A thread that waits for events or ends."""

    __slots__ = ("names", "endings", "task", "found")

    def __init__(self, names: frozenset[str], endings: tuple[Ending, ...], task: Any) -> None:
        self.names, self.endings, self.task = names, endings, task
        self.found: Any = None


class EventBox:
    """All of them, in the order in which they happened."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._events: deque[tuple[int, dict[str, Any]]] = deque(maxlen=KEPT)
        self._hearers: list[_Hearer] = []
        self._names: set[str] = set()  # of events that the actor hears, as far as is known
        self._count = 0  # of what has arrived

    def arrived(self, event: dict[str, Any]) -> None:
        """It goes to the thread that waits for it for longest, or waits itself."""
        self._count += 1
        name = event["name"]
        self._names.add(name)
        for hearer in self._hearers:
            if name in hearer.names:
                self._give(hearer, event)
                return
        self._events.append((self._count, event))

    def ended(self, ending: Ending) -> None:
        """All that wait for it are told."""
        self._count += 1
        ending._place = self._count
        for hearer in list(self._hearers):
            if ending in hearer.endings:
                self._give(hearer, ending)

    def _give(self, hearer: _Hearer, found: object) -> None:
        hearer.found = found
        self._hearers.remove(hearer)
        if hearer.task is not None:
            self._exchange.scheduler.unpark(hearer.task)

    def check(self, names: Iterable[str]) -> None:
        """Raises `ProtocolError` for names of events that the actor does not hear."""
        new = [name for name in names if name not in self._names]
        if new:
            # The harness looks at names when it drops events, of which it has none any more once they have arrived here.
            self._exchange.scheduler.outside.wait(0, None)
            self._exchange.link.request({"request": "drop", "events": new})
            self._names.update(new)

    def drop(self, names: tuple[str, ...]) -> None:
        """Forgets these events; without names, all."""
        self._exchange.link.request({"request": "drop", "events": list(names)})
        left = [entry for entry in self._events if names and entry[1]["name"] not in names]
        self._events.clear()
        self._events.extend(left)

    def wait(self, names: frozenset[str], endings: tuple[Ending, ...], deadline: int | None) -> Any:
        """Takes the first of these events, or finds what has ended, whichever came first; or waits for either. None at the
        deadline (nanoseconds), at which both still count."""
        exchange = self._exchange
        found = self._there(names, endings)
        if found is not None:
            return found
        hearer = _Hearer(names, endings, exchange.scheduler.current())
        self._hearers.append(hearer)
        try:
            while hearer.found is None:
                if not exchange.park(self, deadline):
                    break
        except BaseException:
            if isinstance(hearer.found, dict):  # an event, which nobody has taken then
                self._events.appendleft((0, hearer.found))
            raise
        finally:
            if hearer in self._hearers:
                self._hearers.remove(hearer)
        return hearer.found

    def _there(self, names: frozenset[str], endings: tuple[Ending, ...]) -> Any:
        first = min((ending for ending in endings if ending._place), key=lambda ending: ending._place, default=None)
        for at, (place, event) in enumerate(self._events):
            if first is not None and first._place < place:
                break
            if event["name"] in names:
                del self._events[at]
                return event
        return first
