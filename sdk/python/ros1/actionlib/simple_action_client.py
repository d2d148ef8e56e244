"""`SimpleActionClient`: one goal at a time."""

from __future__ import annotations

import threading

import rospy
from actionlib.action_client import ActionClient, ClientGoalHandle, CommState, get_name_of_constant
from actionlib_msgs.msg import GoalStatus
from hrdsl.exchange import the_exchange

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    Callback = Callable[..., Any] | None

__all__ = ["SimpleActionClient", "SimpleGoalState", "GoalStatus"]


class SimpleGoalState:
    """What there is to know of the goal."""

    PENDING = 0
    ACTIVE = 1
    DONE = 2

    to_string = classmethod(get_name_of_constant)


class SimpleActionClient:
    """Gives goals to the server of a name, and follows the last. It can be made before the node is."""

    def __init__(self, ns: str, ActionSpec: Any) -> None:
        self.action_client = ActionClient(ns, ActionSpec)
        self.simple_state = SimpleGoalState.DONE
        self.gh: ClientGoalHandle | None = None
        self.done_condition = threading.Condition()
        rospy.core.add_shutdown_hook(self._wake)

    def _wake(self, reason: str) -> None:
        with self.done_condition:
            self.done_condition.notify_all()

    def wait_for_server(self, timeout: Any = rospy.Duration()) -> bool:
        """Waits until there is a server, at most for a `rospy.Duration`; zero is for ever."""
        return self.action_client.wait_for_server(timeout)

    def send_goal(self, goal: Any, done_cb: Callback = None, active_cb: Callback = None, feedback_cb: Callback = None) -> None:
        """Gives a goal, and forgets the one before, which is not cancelled.

        Calls `active_cb()`, `feedback_cb(feedback)` and `done_cb(state, result)`, each in a thread of its own.
        """
        self.stop_tracking_goal()
        self.done_cb = done_cb
        self.active_cb = active_cb
        self.feedback_cb = feedback_cb
        self.simple_state = SimpleGoalState.PENDING
        self.gh = self.action_client.send_goal(goal, self._handle_transition, self._handle_feedback)

    def send_goal_and_wait(
        self, goal: Any, execute_timeout: Any = rospy.Duration(), preempt_timeout: Any = rospy.Duration()
    ) -> int:
        """Gives a goal and waits for its end, which it asks for after the first timeout and waits for until the second.
        Returns the state (`GoalStatus`)."""
        self.send_goal(goal)
        if not self.wait_for_result(execute_timeout):
            rospy.logdebug("Canceling goal")
            self.cancel_goal()
            if self.wait_for_result(preempt_timeout):
                rospy.logdebug("Preempt finished within specified preempt_timeout [%.2f]", preempt_timeout.to_sec())
            else:
                rospy.logdebug("Preempt didn't finish specified preempt_timeout [%.2f]", preempt_timeout.to_sec())
        return self.get_state()

    def wait_for_result(self, timeout: Any = rospy.Duration()) -> bool:
        """Waits for the end of the goal, at most for a `rospy.Duration` (zero is for ever): whether it has ended."""
        if not self.gh:
            rospy.logerr("Called wait_for_result when no goal exists")
            return False
        deadline = rospy.get_rostime() + timeout
        with self.done_condition:
            while not rospy.is_shutdown() and self.simple_state != SimpleGoalState.DONE:
                left = None
                if timeout > rospy.Duration(0.0):
                    left = (deadline - rospy.get_rostime()).to_sec()
                    if left <= 0:
                        break
                self.done_condition.wait(left)
        return self.simple_state == SimpleGoalState.DONE

    def get_result(self) -> Any:
        """The result; None before there is one."""
        if not self.gh:
            rospy.logerr("Called get_result when no goal is running")
            return None
        return self.gh.get_result()

    def get_state(self) -> int:
        """The state of the goal (`GoalStatus`); LOST if there is none."""
        if not self.gh:
            the_exchange().polled("goal")
            return int(GoalStatus.LOST)
        status = self.gh.get_goal_status()
        if status == GoalStatus.RECALLING:
            return int(GoalStatus.PENDING)
        return int(GoalStatus.ACTIVE) if status == GoalStatus.PREEMPTING else status

    def get_goal_status_text(self) -> str:
        """What the server said with the state."""
        if not self.gh:
            rospy.logerr("Called get_goal_status_text when no goal is running")
            return "ERROR: Called get_goal_status_text when no goal is running"
        return self.gh.get_goal_status_text()

    def cancel_all_goals(self) -> None:
        """Asks the server to end all goals that it has, those of other clients, too."""
        self.action_client.cancel_all_goals()

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Asks the server to end those that this client gave until then."""
        self.action_client.cancel_goals_at_and_before_time(time)

    def cancel_goal(self) -> None:
        """Asks the server to end the goal."""
        if self.gh:
            self.gh.cancel()

    def stop_tracking_goal(self) -> None:
        """Forgets the goal, which goes on."""
        self.gh = None

    # ── in the threads of the client ──

    def _handle_transition(self, gh: ClientGoalHandle) -> None:
        if gh != self.gh:
            return
        state = gh.comm_state_machine.state
        if state in (CommState.ACTIVE, CommState.PREEMPTING):
            if self.simple_state == SimpleGoalState.PENDING:
                self.simple_state = SimpleGoalState.ACTIVE
                if self.active_cb:
                    self.active_cb()
            elif self.simple_state == SimpleGoalState.DONE:
                self._say_wrong(state)
        elif state == CommState.DONE:
            if self.simple_state == SimpleGoalState.DONE:
                rospy.logerr("SimpleActionClient received DONE twice")
                return
            if self.done_cb:
                self.done_cb(gh.get_goal_status(), gh.get_result())
            # Who waits for the result goes on after the callback.
            with self.done_condition:
                self.simple_state = SimpleGoalState.DONE
                self.done_condition.notify_all()

    def _say_wrong(self, state: int) -> None:
        rospy.logerr(
            "Received comm state %s when in simple state %s with SimpleActionClient in NS %s"
            % (
                CommState.to_string(state),
                SimpleGoalState.to_string(self.simple_state),
                rospy.resolve_name(self.action_client.ns),
            )
        )

    def _handle_feedback(self, gh: ClientGoalHandle, feedback: Any) -> None:
        if self.gh is not None and gh == self.gh and self.feedback_cb:
            self.feedback_cb(feedback)
