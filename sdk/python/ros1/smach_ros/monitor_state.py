"""`MonitorState`: listens to a topic for as long as a condition holds."""

from __future__ import annotations

import threading

import rospy
import smach

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

__all__ = ["MonitorState"]


class MonitorState(smach.State):
    """`invalid` at the first message for which the condition does not hold, `valid` after so many for which it does."""

    def __init__(
        self,
        topic: str,
        msg_type: Any,
        cond_cb: Callable[[Any, Any], Any],
        max_checks: int = -1,
        input_keys: list[str] = [],
        output_keys: list[str] = [],
    ) -> None:
        outcomes = ["valid", "invalid", "preempted"]
        smach.State.__init__(self, outcomes=outcomes, input_keys=input_keys, output_keys=output_keys)
        self._topic = topic
        self._msg_type = msg_type
        self._cond_cb = cond_cb
        self._max_checks = max_checks
        self._n_checks = 0
        self._trigger_event = threading.Event()

    def execute(self, ud: Any) -> str:
        """Listens."""
        if self.preempt_requested():
            self.service_preempt()
            return "preempted"
        self._n_checks = 0
        self._trigger_event.clear()
        self._sub = rospy.Subscriber(self._topic, self._msg_type, self._cb, callback_args=ud)
        self._trigger_event.wait()
        self._sub.unregister()
        if self.preempt_requested():
            self.service_preempt()
            return "preempted"
        return "valid" if self._is_enough() else "invalid"

    def _is_enough(self) -> bool:
        return 0 < self._max_checks <= self._n_checks

    def _cb(self, msg: Any, ud: Any) -> None:
        try:
            if self._cond_cb(ud, msg):
                self._n_checks += 1
            else:
                self._trigger_event.set()
        except Exception as error:
            rospy.logerr("Error thrown while executing condition callback %s: %s" % (str(self._cond_cb), error))
            self._trigger_event.set()
        if self._is_enough():
            self._trigger_event.set()

    def request_preempt(self) -> None:
        """Ends it."""
        smach.State.request_preempt(self)
        self._trigger_event.set()
