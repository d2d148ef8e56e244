"""What callbacks say of the outcomes and userdata that they bring to a state, and when machines have to stop."""

from __future__ import annotations

import smach

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

__all__ = ["is_shutdown", "set_shutdown_check", "cb_interface", "has_smach_interface", "CBInterface"]


def is_shutdown() -> bool:
    """Whether all machines are to stop; `set_shutdown_check` replaces it."""
    return False


def set_shutdown_check(cb: Callable[[], bool]) -> None:
    """`cb` says from now on whether machines are to stop before their next state."""
    smach.is_shutdown = cb


def has_smach_interface(obj: object) -> bool:
    """Whether it says which keys and outcomes it has."""
    names = ("get_registered_input_keys", "get_registered_output_keys", "get_registered_outcomes")
    return all(hasattr(obj, name) for name in names)


class cb_interface:
    """Decorates a callback with the keys and outcomes that it has."""

    def __init__(self, outcomes: Any = None, input_keys: Any = None, output_keys: Any = None) -> None:
        self._outcomes = outcomes or []
        self._input_keys = input_keys or []
        self._output_keys = output_keys or []

    def __call__(self, cb: Callable[..., Any]) -> CBInterface:
        return CBInterface(cb, self._outcomes, self._input_keys, self._output_keys)


class CBInterface:
    """A callback with the keys and outcomes that it has."""

    def __init__(
        self,
        cb: Callable[..., Any],
        outcomes: Iterable[str] | None = None,
        input_keys: Iterable[str] | None = None,
        output_keys: Iterable[str] | None = None,
        io_keys: Iterable[str] | None = None,
    ) -> None:
        # As in the original, `io_keys` are accepted and have no effect.
        self._input_keys = dict.fromkeys(input_keys or ())
        self._output_keys = dict.fromkeys(output_keys or ())
        self._outcomes = outcomes or []
        self._cb = cb

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self._cb(*args, **kwargs)

    def get_registered_input_keys(self) -> tuple[str, ...]:
        """The keys that it may read."""
        return tuple(self._input_keys)

    def get_registered_output_keys(self) -> tuple[str, ...]:
        """The keys that it may write."""
        return tuple(self._output_keys)

    def get_registered_outcomes(self) -> tuple[str, ...]:
        """The outcomes that it may return."""
        return tuple(self._outcomes)
