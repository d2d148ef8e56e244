"""What states of services and of actions share: how goals and requests come from userdata, and results get there."""

from __future__ import annotations

import rospy
import smach
from smach.container import trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class Called:
    """A callback of the program, with its arguments and the keys that it reads and writes."""

    def __init__(
        self, state: smach.State, callback: Any, args: Any, kwargs: Any, keys: tuple[list[str], list[str]], wrong: str
    ) -> None:
        if callback is not None and not callable(callback):
            raise smach.InvalidStateError(wrong)
        self.callback = callback
        self._args, self._kwargs = args, kwargs
        self._inputs, self._outputs = keys
        if smach.has_smach_interface(callback):
            self._inputs = callback.get_registered_input_keys()
            self._outputs = callback.get_registered_output_keys()
            state.register_input_keys(self._inputs)
            state.register_output_keys(self._outputs)

    def outcomes(self, state: smach.State) -> None:
        """Those that a callback declares are the state's, too."""
        if smach.has_smach_interface(self.callback):
            state.register_outcomes(self.callback.get_registered_outcomes())

    def __call__(self, ud: Any, *given: Any) -> Any:
        view = smach.Remapper(ud, self._inputs, self._outputs, [])
        return self.callback(view, *given, *self._args, **self._kwargs)


def attempt(what: str, call: Callable[[], Any]) -> tuple[bool, Any]:
    """Whether the program's code has run, and what it has returned; a failure is logged."""
    try:
        return True, call()
    except BaseException as error:
        if smach.is_the_end(error):
            raise
        rospy.logerr("Could not execute %s: %s" % (what, trace()))
        return False, None
