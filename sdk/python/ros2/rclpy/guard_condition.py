"""Callbacks that the program itself triggers."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class GuardCondition:
    """Lets an executor run a callback."""

    def __init__(self, callback: Any, callback_group: Any, context: Any = None) -> None:
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False
        self._executor_triggered = False
        self._is_destroyed = False
        self._wake: Callable[[], None] | None = None

    def trigger(self) -> None:
        """The callback is to run."""
        self._executor_triggered = True
        if self._wake is not None:
            self._wake()

    def _is_ready(self, now: int) -> bool:
        return self._executor_triggered

    def _take(self) -> tuple[Any, tuple[Any, ...]] | None:
        self._executor_triggered = False
        return self.callback, ()

    def destroy(self) -> None:
        """It is triggered no more."""
        self._is_destroyed = True
        self._executor_triggered = False
