"""`ActionServer`: gets the goals of an action, several at a time, and says what becomes of each."""

from __future__ import annotations

import threading

import rospy
from actionlib import _wire
from actionlib._lanes import Lane
from actionlib.goal_id_generator import GoalIDGenerator
from actionlib.server_goal_handle import ServerGoalHandle, StatusTracker
from actionlib_msgs.msg import GoalStatus
from hrdsl.exchange import the_exchange

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

#: How the protocol calls ends.
_ENDS = {
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.ABORTED: "aborted",
    GoalStatus.PREEMPTED: "canceled",
    GoalStatus.RECALLED: "canceled",
    GoalStatus.REJECTED: "rejected",
}


def nop_cb(goal_handle: Any) -> None:
    """Does nothing about a request to end a goal."""


class ActionServer:
    """Calls `goal_cb(handle)` for each goal, and `cancel_cb(handle)` when a client asks for the end of one."""

    def __init__(
        self,
        ns: str,
        ActionSpec: Any,
        goal_cb: Any,
        cancel_cb: Callable[[Any], Any] = nop_cb,
        auto_start: bool = True,
    ) -> None:
        self.ns = ns
        self.ActionSpec = ActionSpec
        self._spec = _wire.Spec(ActionSpec)
        self.ActionGoal = self._spec.action_goal
        self.ActionResult = self._spec.action_result
        self.ActionResultType = self._spec.result
        self.ActionFeedback = self._spec.action_feedback
        self.lock = threading.RLock()
        self.status_list: list[StatusTracker] = []  # of goals that have not ended
        self.id_generator = GoalIDGenerator()
        assert goal_cb
        self.goal_callback = goal_cb
        self.cancel_callback = cancel_cb
        self.auto_start = auto_start
        self.started = False
        self._port: Any = None
        if auto_start:
            rospy.logwarn(
                "You've passed in true for auto_start to the python action server, you should always pass in false to"
                " avoid race conditions."
            )
            self.start()

    def register_goal_callback(self, cb: Callable[[Any], Any]) -> None:
        """Replaces what is called for goals."""
        self.goal_callback = cb

    def register_cancel_callback(self, cancel_cb: Callable[[Any], Any]) -> None:
        """Replaces what is called for requests to end goals."""
        self.cancel_callback = cancel_cb

    def start(self) -> None:
        """From now on there is a server of this name."""
        with self.lock:
            if self._port is None:
                self._name: str = rospy.resolve_name(self.ns)
                self._goals = Lane(self._name + "/goal", self.internal_goal_callback)
                self._cancels = Lane(self._name + "/cancel", self.internal_cancel_callback)
                self._port = the_exchange().open("action_server", self._name, self._spec.type, handler=self._hear)
            self.started = True

    def stop(self) -> None:
        """There is no server of this name any more; goals that have not ended are lost."""
        with self.lock:
            self.started = False
            if self._port is not None:
                self._port.close()
                self._port = None

    def publish_status(self) -> None:
        """Does nothing: clients are told when a goal is accepted, is to be canceled, and ends."""

    def publish_result(self, tracker: StatusTracker, result: Any) -> None:
        """The goal has ended."""
        message = _wire.encode(result, self._spec.result, self._name)
        if tracker in self.status_list:
            self.status_list.remove(tracker)
            if not rospy.is_shutdown():
                status = tracker.status
                the_exchange().finish(tracker.number, _ENDS[status.status], message, status.text)

    def publish_acceptance(self, tracker: StatusTracker) -> None:
        """The goal is worked at from now on."""
        if tracker in self.status_list and not rospy.is_shutdown():
            the_exchange().accept(tracker.number, tracker.status.text)

    def publish_feedback(self, tracker: StatusTracker, feedback: Any) -> None:
        """Tells the client of a goal how it gets on."""
        message = _wire.encode(feedback, self._spec.feedback, self._name)
        if tracker in self.status_list and not rospy.is_shutdown():
            the_exchange().feedback(tracker.number, message)

    def _hear(self, arrival: dict[str, Any]) -> None:
        # Called while all threads of the program wait: it only hands on.
        if "called" in arrival:
            self._goals.put(arrival["called"], arrival["message"])
        elif "canceled" in arrival:
            self._cancels.put(arrival["canceled"])

    # ── in the server's threads ──

    def internal_goal_callback(self, number: int, message: Any) -> None:
        """A goal has come."""
        goal = _wire.decode(message, self._spec.goal)
        with self.lock:
            if not self.started:
                return
            rospy.logdebug("The action server has received a new goal request")
            tracker = StatusTracker(number, goal, self.id_generator.generate_ID())
            self.status_list.append(tracker)
            self.goal_callback(ServerGoalHandle(tracker, self))

    def internal_cancel_callback(self, number: int) -> None:
        """A client asks for the end of a goal."""
        with self.lock:
            if not self.started:
                return
            rospy.logdebug("The action server has received a new cancel request")
            for tracker in self.status_list:
                if tracker.number == number:
                    handle = ServerGoalHandle(tracker, self)
                    is_new = handle.set_cancel_requested()
                    the_exchange().answer_cancel(number, True, tracker.status.text)
                    if is_new:
                        self.cancel_callback(handle)
                    return
