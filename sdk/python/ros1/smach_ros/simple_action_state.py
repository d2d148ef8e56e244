"""`SimpleActionState`: gives a goal to the server of an action, and waits for its end."""

from __future__ import annotations

import copy
import threading

import rospy
import smach
from actionlib import GoalStatus, SimpleActionClient
from smach_ros._filling import Called, attempt

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["SimpleActionState"]


class SimpleActionState(smach.State):
    """Gives a goal that is given, or made of userdata, and puts the result there."""

    WAITING_FOR_SERVER = 0
    INACTIVE = 1
    ACTIVE = 2
    PREEMPTING = 3
    COMPLETED = 4

    def __init__(
        self,
        action_name: str,
        action_spec: Any,
        goal: Any = None,
        goal_key: str | None = None,
        goal_slots: list[str] = [],
        goal_cb: Any = None,
        goal_cb_args: Any = [],
        goal_cb_kwargs: Any = {},
        result_key: str | None = None,
        result_slots: list[str] = [],
        result_cb: Any = None,
        result_cb_args: Any = [],
        result_cb_kwargs: Any = {},
        input_keys: list[str] = [],
        output_keys: list[str] = [],
        outcomes: list[str] = [],
        exec_timeout: Any = None,
        preempt_timeout: Any = rospy.Duration(60.0),
        server_wait_timeout: Any = rospy.Duration(60.0),
    ) -> None:
        smach.State.__init__(self, outcomes=["succeeded", "aborted", "preempted"])
        self._action_name = action_name
        self._exec_timeout = exec_timeout
        self._server_wait_timeout = server_wait_timeout
        self._goal_status, self._goal_result = 0, None
        empty = action_spec()
        self._check(goal, goal_slots, empty.action_goal.goal, result_slots, empty.action_result.result)
        self._goal = copy.copy(empty.action_goal.goal) if goal is None else goal
        keys = input_keys, output_keys
        wrong = "%s callback object given to SimpleActionState that IS NOT a function object"
        self._goal_cb = Called(self, goal_cb, goal_cb_args, goal_cb_kwargs, keys, wrong % "Goal")
        # As in the original, the arguments of the result's callback are not handed on.
        self._result_cb = Called(self, result_cb, [], {}, keys, wrong % "Result")
        self._result_cb.outcomes(self)
        self._goal_key, self._goal_slots = goal_key, goal_slots
        self._result_key, self._result_slots = result_key, result_slots
        self.register_input_keys([*goal_slots, *([] if goal_key is None else [goal_key]), *input_keys])
        self.register_output_keys([*result_slots, *([] if result_key is None else [result_key]), *output_keys])
        self.register_outcomes(outcomes)
        self._activate_time = rospy.Time.now()
        self._status = SimpleActionState.WAITING_FOR_SERVER
        self._done_cond = threading.Condition()
        self._action_client = SimpleActionClient(action_name, action_spec)
        name = action_name + "/wait_for_server"
        self._action_wait_thread = threading.Thread(name=name, target=self._wait_for_server)
        self._action_wait_thread.start()

    def _check(self, goal: Any, goal_slots: list[str], empty: Any, result_slots: list[str], result: Any) -> None:
        if goal and callable(goal):
            raise smach.InvalidStateError("Goal object given to SimpleActionState that IS a function object")
        if not all(slot in empty.__slots__ for slot in goal_slots):
            raise smach.InvalidStateError(
                "Goal slots specified are not valid slots. Available slots: %s; specified slots: %s"
                % (empty.__slots__, goal_slots)
            )
        if not all(slot in result.__slots__ for slot in result_slots):
            raise smach.InvalidStateError("Result slots specified are not valid slots.")

    # ── before the goal ──

    def _wait_for_server(self) -> None:
        """In a thread of its own, so that other states can be made meanwhile."""
        deadline = rospy.get_rostime() + self._server_wait_timeout
        waiting = SimpleActionState.WAITING_FOR_SERVER
        while self._status == waiting and not rospy.is_shutdown() and rospy.get_rostime() < deadline:
            try:
                if self._action_client.wait_for_server(rospy.Duration(1.0)):
                    self._status = SimpleActionState.INACTIVE
                if self.preempt_requested():
                    return
            except Exception:
                if not rospy.is_shutdown():
                    rospy.logerr("Failed to wait for action server '%s'" % self._action_name)
                    raise

    def execute(self, ud: Any) -> Any:
        """Gives the goal, and waits for its end."""
        self._connect()
        if self.preempt_requested():
            rospy.loginfo("Preempting %s before sending goal." % self._action_name)
            self.service_preempt()
            return "preempted"
        if self._status == SimpleActionState.WAITING_FOR_SERVER:
            rospy.logfatal("Action server for " + self._action_name + " is not running.")
            return "aborted"
        self._status = SimpleActionState.INACTIVE
        if not self._fill(ud):
            return "aborted"
        self._activate_time = rospy.Time.now()
        self._status = SimpleActionState.ACTIVE
        with self._done_cond:
            self._action_client.send_goal(self._goal, self._goal_done_cb, self._goal_active_cb, self._goal_feedback_cb)
            if self._exec_timeout:
                name = self._action_name + "/preempt_watchdog"
                threading.Thread(name=name, target=self._execution_timer).start()
            self._done_cond.wait()
            return self._ended(ud)

    def _connect(self) -> None:
        if self._status != SimpleActionState.WAITING_FOR_SERVER:
            return
        rospy.logwarn("Still waiting for action server '%s' to start... is it running?" % self._action_name)
        if self._action_wait_thread.is_alive():
            self._action_wait_thread.join()
        else:
            self._wait_for_server()
        if not self.preempt_requested():
            rospy.loginfo("Connected to action server '%s'." % self._action_name)

    def _fill(self, ud: Any) -> bool:
        if self._goal_key is not None:
            self._goal = ud[self._goal_key]
        for key in self._goal_slots:
            setattr(self._goal, key, ud[key])
        if self._goal_cb.callback is not None:
            done, update = attempt("goal callback", lambda: self._goal_cb(ud, self._goal))
            if not done:
                return False
            self._goal = self._goal if update is None else update
        return True

    # ── while the goal is worked at ──

    def _execution_timer(self) -> None:
        while self._status == SimpleActionState.ACTIVE and not rospy.is_shutdown():
            try:
                rospy.sleep(0.1)
            except Exception:
                if not rospy.is_shutdown():
                    rospy.logerr("Failed to sleep while running '%s'" % self._action_name)
                    raise
            if rospy.Time.now() - self._activate_time > self._exec_timeout:
                seconds = self._exec_timeout.to_sec()
                rospy.logwarn("Action %s timed out after %d seconds." % (self._action_name, seconds))
                self._action_client.cancel_goal()

    def request_preempt(self) -> None:
        """Asks the server to end the goal."""
        rospy.loginfo("Preempt requested on action '%s'" % self._action_name)
        smach.State.request_preempt(self)
        if self._status == SimpleActionState.ACTIVE:
            rospy.loginfo("Preempt on action '%s' cancelling goal: \n%s" % (self._action_name, str(self._goal)))
            self._action_client.cancel_goal()

    def _goal_active_cb(self) -> None:
        rospy.logdebug("Action " + self._action_name + " has gone active.")

    def _goal_feedback_cb(self, feedback: Any) -> None:
        rospy.logdebug("Action " + self._action_name + " sent feedback.")

    def _goal_done_cb(self, result_state: int, result: Any) -> None:
        duration = rospy.Time.now() - self._activate_time
        rospy.logdebug(
            "Action %s terminated after %s seconds with result %s."
            % (self._action_name, duration.to_sec(), GoalStatus.to_string(self._action_client.get_state()))
        )
        self._goal_status, self._goal_result = result_state, result
        self._status = SimpleActionState.INACTIVE
        with self._done_cond:
            self._done_cond.notify()

    # ── after the goal ──

    def _ended(self, ud: Any) -> Any:
        outcome = None
        if self._result_cb.callback is not None:
            given = self._goal_status, self._goal_result
            done, outcome = attempt("result callback", lambda: self._result_cb(ud, *given))
            if not done:
                return "aborted"
            if outcome is not None and outcome not in self.get_registered_outcomes():
                rospy.logerr(
                    "Result callback for action %s, %s was not registered with the result_cb_outcomes argument. The result"
                    " callback returned '%s' but the only registered outcomes are: %s"
                    % (self._action_name, self._result_cb.callback, outcome, self.get_registered_outcomes())
                )
                return "aborted"
        if self._result_key is not None:
            ud[self._result_key] = self._goal_result
        if self._goal_result is not None:
            for key in self._result_slots:
                ud[key] = getattr(self._goal_result, key)
        by_itself = self._own_outcome()
        self._status = SimpleActionState.INACTIVE
        return by_itself if outcome is None else outcome

    def _own_outcome(self) -> str:
        if self._status != SimpleActionState.INACTIVE:
            rospy.logwarn("Action state terminated without going inactive first.")
            return "aborted"
        if self._goal_status == GoalStatus.SUCCEEDED:
            return "succeeded"
        if self._goal_status == GoalStatus.PREEMPTED and self.preempt_requested():
            self.service_preempt()
            return "preempted"
        return "aborted"
