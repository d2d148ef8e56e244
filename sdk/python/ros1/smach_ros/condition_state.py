"""`ConditionState`: waits until a condition holds."""

from __future__ import annotations

import rospy
import smach
from smach.container import trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

__all__ = ["ConditionState"]


class ConditionState(smach.State):
    """Asks the condition again and again: `true` when it holds, `false` after so many times or so much time."""

    def __init__(
        self,
        cond_cb: Callable[..., Any],
        input_keys: list[str] = [],
        poll_rate: Any = rospy.Duration(0.05),
        timeout: Any = None,
        max_checks: int = 1,
    ) -> None:
        smach.State.__init__(self, outcomes=["true", "false", "preempted"], input_keys=input_keys)
        self._cond_cb = cond_cb
        if hasattr(cond_cb, "get_registered_input_keys") and hasattr(cond_cb, "get_registered_output_keys"):
            described: Any = cond_cb
            self.register_input_keys(described.get_registered_input_keys())
            self.register_output_keys(described.get_registered_output_keys())
        self._poll_rate = poll_rate
        self._timeout = timeout
        self._max_checks = max_checks

    def execute(self, ud: Any) -> str:
        """Asks."""
        start, checks = rospy.Time.now(), 0
        while self._max_checks == -1 or checks <= self._max_checks:  # once more than it says, as in the original
            if self._timeout and rospy.Time.now() - start > self._timeout:
                break
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            try:
                if self._cond_cb(ud):
                    return "true"
            except BaseException as error:
                if smach.is_the_end(error):
                    raise
                raise smach.InvalidUserCodeError(
                    "Error thrown while executing condition callback %s: %s" % (self._cond_cb, trace())
                ) from error
            checks += 1
            rospy.sleep(self._poll_rate)
        return "false"
