"""What `message_filters` of ROS 1 and of ROS 2 have in common: filters in chains, caches, and messages of several topics by their
stamps. Stamps are whole nanoseconds here; the two modules say what is one in a message."""

from __future__ import annotations

import bisect
import itertools
import threading

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Sequence


class SimpleFilter:
    """What hands on messages to those who have registered."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Calls it with each message, or with all that belong together, and these arguments behind them: its number."""
        number = len(self.callbacks)
        self.callbacks[number] = cb, args
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Hands these on."""
        for call, args in list(self.callbacks.values()):
            call(*msg, *args)


class StampedFilter(SimpleFilter):
    """What looks at the stamps of messages."""

    def __init__(self, allow_headerless: bool = False) -> None:
        super().__init__()
        self.allow_headerless = allow_headerless

    def stamp_of(self, message: Any) -> int | None:
        """Nanoseconds; None, after a warning, if it has none and may not go without."""
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        if stamp is not None:
            return self.nanoseconds(stamp)
        if self.allow_headerless:
            return self.present()
        self.warn(
            "Cannot use message filters with non-stamped messages. Use the 'allow_headerless' constructor option to"
            " auto-assign ROS time to headerless messages."
        )
        return None

    def nanoseconds(self, stamp: Any) -> int:
        """Those of a stamp, as messages and programs have it."""
        raise NotImplementedError

    def present(self) -> int:
        """What a message without a stamp gets."""
        raise NotImplementedError

    def warn(self, text: str) -> None:
        """Says it in the log."""
        raise NotImplementedError


class Cached(StampedFilter):
    """Keeps the last messages that have come, and hands them on."""

    def __init__(self, f: SimpleFilter, cache_size: int, allow_headerless: bool) -> None:
        super().__init__(allow_headerless)
        self.cache_size = cache_size
        self.cache_msgs: list[Any] = []  # as they have come
        self._stamps: list[int] = []
        self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:
        """Hears of a filter's messages."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Keeps a message; of too many, the one that came first goes."""
        stamp = self.stamp_of(msg)
        if stamp is None:
            return
        self._stamps.append(stamp)
        self.cache_msgs.append(msg)
        if len(self.cache_msgs) > self.cache_size:
            del self._stamps[0], self.cache_msgs[0]
        self.signalMessage(msg)

    def _in_order(self) -> tuple[list[int], list[Any]]:
        order = sorted(range(len(self._stamps)), key=self._stamps.__getitem__)
        return [self._stamps[place] for place in order], [self.cache_msgs[place] for place in order]

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:
        """The messages with stamps from one to the other, both included."""
        stamps, messages = self._in_order()
        first = bisect.bisect_left(stamps, self.nanoseconds(from_stamp))
        return messages[first : bisect.bisect_right(stamps, self.nanoseconds(to_stamp))]

    def getElemAfterTime(self, stamp: Any) -> Any:
        """The first with this stamp or a later one; None if there is none."""
        stamps, messages = self._in_order()
        place = bisect.bisect_left(stamps, self.nanoseconds(stamp))
        return messages[place] if place < len(messages) else None

    def getElemBeforeTime(self, stamp: Any) -> Any:
        """The last with this stamp or an earlier one; None if there is none."""
        stamps, messages = self._in_order()
        place = bisect.bisect_right(stamps, self.nanoseconds(stamp))
        return messages[place - 1] if place else None

    def getLast(self) -> Any:
        """The message with the latest stamp; None if there is none."""
        return self._in_order()[1][-1] if self._stamps else None


class Synchronized(StampedFilter):
    """Hands on messages of all its inputs together that have the same stamp."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int, allow_headerless: bool = False) -> None:
        super().__init__(allow_headerless)
        self.queue_size = queue_size
        self.lock = threading.Lock()
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:
        """Hears of the messages of these, and of no others any more."""
        self.queues: list[dict[int, Any]] = [{} for _ in fs]
        pairs = enumerate(zip(fs, self.queues))
        self.input_connections = [each.registerCallback(self.add, queue, place) for place, (each, queue) in pairs]

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """A message of one of the inputs; of too many that wait, the oldest stamps go."""
        stamp = self.stamp_of(msg)
        if stamp is None:
            return
        with self.lock:
            my_queue[stamp] = msg
            while len(my_queue) > self.queue_size:
                del my_queue[min(my_queue)]
            self.match(stamp, my_queue)

    def match(self, stamp: int, queue: dict[int, Any]) -> None:
        """Hands on what belongs together, now that a queue has a message of this stamp."""
        if all(stamp in each for each in self.queues):
            self._hand_on([stamp] * len(self.queues))

    def _hand_on(self, stamps: Sequence[int]) -> None:
        messages = [queue.pop(stamp) for queue, stamp in zip(self.queues, stamps)]
        self.signalMessage(*messages)


class Approximated(Synchronized):
    """Hands on messages of all its inputs together whose stamps lie nearer to each other than `slop` nanoseconds."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int, slop: int, allow_headerless: bool) -> None:
        self.slop_ns = slop
        super().__init__(fs, queue_size, allow_headerless)

    def match(self, stamp: int, queue: dict[int, Any]) -> None:
        """Of each other input it takes, from the nearest on, those that are near enough to this stamp."""
        if stamp not in queue:
            return
        choices = []
        for each in self.queues:
            near = [stamp] if each is queue else [other for other in each if abs(other - stamp) <= self.slop_ns]
            if not near:
                return
            choices.append(sorted(near, key=lambda other: abs(other - stamp)))
        for stamps in itertools.product(*choices):
            if max(stamps) - min(stamps) < self.slop_ns:
                self._hand_on(stamps)
                return
