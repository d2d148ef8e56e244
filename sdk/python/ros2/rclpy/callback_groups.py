"""Which callbacks may run at the same time."""

from __future__ import annotations

from weakref import ref

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class CallbackGroup:
    """The base of groups."""

    def __init__(self) -> None:
        super().__init__()
        self.entities: set[Any] = set()

    def add_entity(self, entity: Any) -> None:
        """Its callbacks belong to this group."""
        self.entities.add(ref(entity))

    def has_entity(self, entity: Any) -> bool:
        """Whether its callbacks do."""
        return ref(entity) in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Whether a callback could run now."""
        raise NotImplementedError()

    def beginning_execution(self, entity: Any) -> bool:
        """A callback is about to run: whether it may."""
        raise NotImplementedError()

    def ending_execution(self, entity: Any) -> None:
        """It has run."""
        raise NotImplementedError()


class ReentrantCallbackGroup(CallbackGroup):
    """All at the same time."""

    def can_execute(self, entity: Any) -> bool:
        """Always."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Always."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Nothing changes by it."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """One after the other."""

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Any = None

    def can_execute(self, entity: Any) -> bool:
        """If no other runs."""
        return self._active_entity is None

    def beginning_execution(self, entity: Any) -> bool:
        """If no other runs."""
        if self._active_entity is not None:
            return False
        self._active_entity = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """The next one may run."""
        self._active_entity = None
