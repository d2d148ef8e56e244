"""`State`, the base of all states, and `CBState`, which is one function."""

from __future__ import annotations

import smach
from smach import _told

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

__all__ = ["State", "CBState"]


def _in_order(names: set[Any]) -> tuple[Any, ...]:
    # The order of a set of texts follows the seed of hashes; what is printed and told is not to.
    return tuple(sorted(names, key=str))


class State:
    """A state has outcomes, one of which its `execute` returns, and keys of userdata that it reads and writes."""

    def __init__(
        self,
        outcomes: Iterable[str] = [],
        input_keys: list[str] = [],
        output_keys: list[str] = [],
        io_keys: list[str] = [],
    ) -> None:
        self._outcomes = set(outcomes)
        self._input_keys = set(input_keys + io_keys)
        self._output_keys = set(output_keys + io_keys)
        self._preempt_requested = False

    def execute(self, ud: Any) -> Any:
        """Does what the state is for, and returns an outcome."""
        raise NotImplementedError()

    def register_outcomes(self, new_outcomes: Iterable[str]) -> None:
        """Adds outcomes."""
        self._outcomes = self._outcomes.union(new_outcomes)

    def get_registered_outcomes(self) -> tuple[str, ...]:
        """All outcomes."""
        return _in_order(self._outcomes)

    def register_io_keys(self, keys: Iterable[str]) -> None:
        """Adds keys that are read and written."""
        keys = list(keys)
        self._input_keys = self._input_keys.union(keys)
        self._output_keys = self._output_keys.union(keys)

    def register_input_keys(self, keys: Iterable[str]) -> None:
        """Adds keys that are read."""
        self._input_keys = self._input_keys.union(keys)

    def get_registered_input_keys(self) -> tuple[str, ...]:
        """All keys that are read."""
        return _in_order(self._input_keys)

    def register_output_keys(self, keys: Iterable[str]) -> None:
        """Adds keys that are written."""
        self._output_keys = self._output_keys.union(keys)

    def get_registered_output_keys(self) -> tuple[str, ...]:
        """All keys that are written."""
        return _in_order(self._output_keys)

    def request_preempt(self) -> None:
        """Asks the state to end soon; it looks by itself (`preempt_requested`)."""
        self._preempt_requested = True

    def service_preempt(self) -> None:
        """To be called by the state when it ends because it was asked to."""
        self._preempt_requested = False

    def recall_preempt(self) -> None:
        """Takes the request back."""
        self._preempt_requested = False

    def preempt_requested(self) -> bool:
        """Whether the state was asked to end."""
        _told.polled()
        return self._preempt_requested


class CBState(State):
    """A state that is a function of the userdata, with further arguments if they are given."""

    def __init__(
        self,
        cb: Callable[..., Any],
        cb_args: Iterable[Any] = [],
        cb_kwargs: dict[str, Any] = {},
        outcomes: Iterable[str] = [],
        input_keys: list[str] = [],
        output_keys: list[str] = [],
        io_keys: list[str] = [],
    ) -> None:
        State.__init__(self, outcomes, input_keys, output_keys, io_keys)
        self._cb = cb
        self._cb_args = cb_args
        self._cb_kwargs = cb_kwargs
        if smach.util.has_smach_interface(cb):
            described: Any = cb
            self.register_input_keys(described.get_registered_input_keys())
            self.register_output_keys(described.get_registered_output_keys())
            self.register_outcomes(described.get_registered_outcomes())

    def execute(self, ud: Any) -> Any:
        """Calls the function."""
        return self._cb(ud, *self._cb_args, **self._cb_kwargs)
