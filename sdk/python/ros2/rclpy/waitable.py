"""Things of other kinds that an executor can wait for."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class NumberOfEntities:
    """How many things of each kind a waitable waits for; not used here."""

    def __init__(self, *counts: int, **named: int) -> None:
        self.counts = counts


class Waitable:
    """The base of such things. Those of a program's own wait for things of ROS's C library, and are refused."""

    _due: int | None = None  # when something is to be done though nothing arrives
    _is_quiet = False  # whether nothing arrived until then

    def __init__(self, callback_group: Any) -> None:
        self.callback_group = callback_group
        self.callback_group.add_entity(self)
        self._executor_event = False
        self._is_destroyed = False
        self._futures: list[Any] = []

    def add_future(self, future: Any) -> None:
        """Its callbacks run in the executor."""
        self._futures.append(future)

    def remove_future(self, future: Any) -> None:
        """They do not any more."""
        self._futures.remove(future)

    def _is_ready(self, now: int) -> bool:
        from rclpy import _world

        _world.unsupported("a Waitable of %s" % type(self).__module__, "use subscriptions, timers and guard conditions")

    def _take(self) -> Any:
        raise NotImplementedError
