"""`ServerGoalHandle`: a goal that a server has got."""

from __future__ import annotations

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_WAITING = (GoalStatus.PENDING, GoalStatus.RECALLING)
_RUNNING = (GoalStatus.ACTIVE, GoalStatus.PREEMPTING)


class StatusTracker:
    """A goal and its status."""

    def __init__(self, number: int, goal: Any, goal_id: Any) -> None:
        self.number = number  # of the call
        self.goal = goal
        self.status = GoalStatus(goal_id=goal_id, status=GoalStatus.PENDING)


class ServerGoalHandle:
    """Says what becomes of a goal. Without a goal it is uninitialized, and says so."""

    def __init__(self, status_tracker: Any = None, action_server: Any = None, handle_tracker: Any = None) -> None:
        self.status_tracker = status_tracker
        self.action_server = action_server
        self.goal = status_tracker.goal if status_tracker else None

    def get_default_result(self) -> Any:
        """An empty result."""
        return self.action_server.ActionResultType()

    def set_accepted(self, text: str = "") -> None:
        """The goal is worked at from now on."""
        if self._is_missing("set status on"):
            return
        with self.action_server.lock:
            status = self.status_tracker.status
            self._log("Accepting goal")
            if status.status not in _WAITING:
                rospy.logerr(
                    "To transition to an active state, the goal must be in a pending or recalling state, it is currently"
                    " in state: %d",
                    status.status,
                )
                return
            status.status = GoalStatus.ACTIVE if status.status == GoalStatus.PENDING else GoalStatus.PREEMPTING
            status.text = text
            self.action_server.publish_acceptance(self.status_tracker)

    def set_canceled(self, result: Any = None, text: str = "") -> None:
        """The goal was given up because somebody asked for it."""
        states = "cancelled", "pending, recalling, active, or preempting"
        self._end(GoalStatus.PREEMPTED, _WAITING + _RUNNING, result, text, "canceled", states)

    def set_rejected(self, result: Any = None, text: str = "") -> None:
        """The goal is not taken on."""
        states = "rejected", "pending or recalling"
        self._end(GoalStatus.REJECTED, _WAITING, result, text, "rejected", states)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """The goal cannot be reached."""
        self._end(GoalStatus.ABORTED, _RUNNING, result, text, "aborted", ("aborted", "preempting or active"))

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """The goal is reached."""
        self._end(GoalStatus.SUCCEEDED, _RUNNING, result, text, "succeeded", ("succeeded", "preempting or active"))

    def _end(self, end: int, allowed: tuple[int, ...], result: Any, text: str, word: str, states: tuple[str, str]) -> None:
        if self._is_missing("set status on"):
            return
        with self.action_server.lock:
            status = self.status_tracker.status
            self._log("Setting status to %s on goal" % word)
            if status.status not in allowed:
                article = "an" if states[0][0] in "aeiou" else "a"
                rospy.logerr(
                    "To transition to %s %s state, the goal must be in a %s state, it is currently in state: %d"
                    % (article, states[0], states[1], status.status)
                )
                return
            if end == GoalStatus.PREEMPTED and status.status in _WAITING:
                end = GoalStatus.RECALLED
            before = status.status, status.text
            status.status, status.text = end, text
            try:
                self.action_server.publish_result(self.status_tracker, result or self.get_default_result())
            except BaseException:
                status.status, status.text = before
                raise

    def publish_feedback(self, feedback: Any) -> None:
        """Tells the client how it gets on."""
        if not self._is_missing("publish feedback on"):
            self._log("Publishing feedback for goal")
            with self.action_server.lock:
                self.action_server.publish_feedback(self.status_tracker, feedback)

    def get_goal(self) -> Any:
        """The goal; None if there is none."""
        return self.goal

    def get_goal_id(self) -> Any:
        """Its identifier."""
        return GoalID() if self._is_missing("get a goal id on") else self.status_tracker.status.goal_id

    def get_goal_status(self) -> Any:
        """Its status."""
        return GoalStatus() if self._is_missing("get goal status on") else self.status_tracker.status

    def set_cancel_requested(self) -> bool:
        """Somebody asks for the end of the goal: whether that is new."""
        if not self.goal:
            return False
        status = self.status_tracker.status
        if status.status == GoalStatus.PENDING:
            status.status = GoalStatus.RECALLING
        elif status.status == GoalStatus.ACTIVE:
            status.status = GoalStatus.PREEMPTING
        else:
            return False
        return True

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ServerGoalHandle) or not self.goal or not other.goal:
            return False
        return bool(self.status_tracker.number == other.status_tracker.number)

    def __hash__(self) -> int:
        return hash(self.get_goal_id().id)

    def _is_missing(self, what: str) -> bool:
        if self.goal:
            return False
        rospy.logerr("Attempt to %s an uninitialized ServerGoalHandle" % what)
        return True

    def _log(self, what: str) -> None:
        goal_id = self.status_tracker.status.goal_id
        rospy.logdebug("%s, id: %s, stamp: %.2f", what, goal_id.id, goal_id.stamp.to_sec())
