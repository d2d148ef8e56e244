"""`Container`: what all states that have states within them share."""

from __future__ import annotations

import threading

import smach
from smach.state import State

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

    Callbacks = list[tuple[Callable[..., Any], Iterable[Any]]]

__all__ = ["Container"]


def trace() -> str:
    """The traceback of the exception that is being handled."""
    import traceback

    return traceback.format_exc()


class _Opened:
    """`with container.opened():`"""

    def __init__(self, container: Container, kwargs: dict[str, Any]) -> None:
        self._container = container
        self._kwargs: Any = kwargs

    def __enter__(self) -> Container:
        self._container.open()
        self._before, Container._context_kwargs = Container._context_kwargs, self._kwargs
        return self._container

    def __exit__(self, *exception: object) -> None:
        Container._context_kwargs = self._before
        self._container.close()


class Container(State):
    """A state with states within. What is added by the functions of a class goes to the container opened last."""

    _construction_stack: list[Container] = []
    _construction_lock = threading.RLock()
    _context_kwargs: Any = []

    def __init__(self, outcomes: Iterable[str] = [], input_keys: list[str] = [], output_keys: list[str] = []) -> None:
        State.__init__(self, outcomes, input_keys, output_keys)
        self.userdata = smach.UserData()
        self._start_cbs: Callbacks = []
        self._transition_cbs: Callbacks = []
        self._termination_cbs: Callbacks = []
        self._told_name: str | None = None
        self._is_told = False

    # ── what kinds of containers have in ways of their own ──

    def __getitem__(self, key: str) -> State:
        raise NotImplementedError()

    def get_children(self) -> dict[str, Any]:
        """The states within, by their labels."""
        raise NotImplementedError()

    def set_initial_state(self, initial_states: Any, userdata: Any) -> None:
        """Where to begin, and with which userdata."""
        raise NotImplementedError()

    def get_initial_states(self) -> list[str]:
        """Where it begins."""
        raise NotImplementedError()

    def get_active_states(self) -> list[str]:
        """Which states run."""
        raise NotImplementedError()

    def get_internal_edges(self) -> list[Any]:
        """(outcome, from, to) for each transition within."""
        raise NotImplementedError()

    def check_consistency(self) -> None:
        """Raises if something leads nowhere."""
        raise NotImplementedError()

    # ── userdata ──

    def _copy_input_keys(self, parent_ud: Any, ud: Any) -> None:
        if parent_ud is not None:
            for key in self.get_registered_input_keys():
                try:
                    ud[key] = parent_ud[key]
                except KeyError:
                    smach.logwarn("Attempting to copy input key '%s', but this key does not exist." % key)

    def _copy_output_keys(self, ud: Any, parent_ud: Any) -> None:
        if parent_ud is not None:
            for key in self.get_registered_output_keys():
                try:
                    parent_ud[key] = ud[key]
                except KeyError:
                    smach.logwarn("Attempting to copy output key '%s', but this key does not exist." % key)

    # ── callbacks ──

    def register_start_cb(self, start_cb: Callable[..., Any], cb_args: Iterable[Any] = []) -> None:
        """Calls `start_cb(userdata, initial_states, *cb_args)` when the container begins."""
        self._start_cbs.append((start_cb, cb_args))

    def register_transition_cb(self, transition_cb: Callable[..., Any], cb_args: Iterable[Any] = []) -> None:
        """Calls `transition_cb(userdata, active_states, *cb_args)` when it goes from state to state."""
        self._transition_cbs.append((transition_cb, cb_args))

    def register_termination_cb(self, termination_cb: Callable[..., Any], cb_args: Iterable[Any] = []) -> None:
        """Calls `termination_cb(userdata, last_states, outcome, *cb_args)` when it ends."""
        self._termination_cbs.append((termination_cb, cb_args))

    def call_start_cbs(self) -> None:
        """Calls those for the beginning; the first that fails is told, and the last that is called."""
        self._call("start", self._start_cbs, lambda: (self.userdata, self.get_initial_states()))

    def call_transition_cbs(self) -> None:
        """Likewise, those for transitions."""
        self._call("transition", self._transition_cbs, lambda: (self.userdata, self.get_active_states()))

    def call_termination_cbs(self, terminal_states: Any, outcome: str) -> None:
        """Likewise, those for the end."""
        self._call("termination", self._termination_cbs, lambda: (self.userdata, terminal_states, outcome))

    def _call(self, kind: str, callbacks: Callbacks, given: Callable[[], tuple[Any, ...]]) -> None:
        try:
            for callback, args in callbacks:
                callback(*given(), *args)
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            smach.logerr("Could not execute %s callback: %s" % (kind, trace()))

    # ── construction ──

    def __enter__(self) -> None:
        self.open()

    def __exit__(self, kind: Any, error: Any, where: Any) -> None:
        # After an exception the container stays open, as in the original.
        if kind is None:
            self.close()
        elif kind not in (smach.InvalidStateError, smach.InvalidTransitionError) and not smach.is_the_end(error):
            import traceback

            text = "\n".join(traceback.format_exception(kind, error, where))
            smach.logerr("Error raised during SMACH container construction: \n" + text)

    def opened(self, **kwargs: Any) -> Any:
        """For a `with`: the container is open within, and is closed in any case."""
        return _Opened(self, kwargs)

    def open(self) -> None:
        """From now on, states are added to this container."""
        Container._construction_stack.append(self)
        Container._construction_lock.acquire()

    def close(self) -> None:
        """Ends `open`, and says if something leads nowhere."""
        stack = Container._construction_stack
        if stack and stack[-1] is not self:
            raise smach.InvalidStateError("Attempting to close a container that is not currently open.")
        stack.pop()
        Container._construction_lock.release()
        try:
            self.check_consistency()
        except (smach.InvalidStateError, smach.InvalidTransitionError):
            smach.logerr("Container consistency check failed.")

    def is_opened(self) -> bool:
        """Whether states are added to this container now."""
        return bool(Container._construction_stack) and Container._construction_stack[-1] is self

    def assert_opened(self, msg: str = "") -> None:
        """Raises if they are not."""
        if not self.is_opened():
            raise smach.InvalidConstructionError(msg)

    @staticmethod
    def _any_containers_opened() -> bool:
        return bool(Container._construction_stack)

    @classmethod
    def _currently_opened_container(cls) -> Any:
        if not Container._construction_stack:
            raise smach.InvalidStateError("Attempting to access the currently opened container, but no container is opened.")
        container = Container._construction_stack[-1]
        if not isinstance(container, cls):
            raise smach.InvalidStateError("Attempting to call a %s construction method without having opened a %s." % (cls, cls))
        return container
