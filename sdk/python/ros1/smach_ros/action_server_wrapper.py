"""`ActionServerWrapper`: a container is executed for each goal of an action."""

from __future__ import annotations

import copy

import rospy
import smach
from actionlib import SimpleActionServer
from smach.container import trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterable, Mapping

__all__ = ["ActionServerWrapper"]


class ActionServerWrapper:
    """Puts the goal into userdata, executes the container, and says by its outcome how the goal has ended."""

    def __init__(
        self,
        server_name: str,
        action_spec: Any,
        wrapped_container: Any,
        succeeded_outcomes: Iterable[str] = [],
        aborted_outcomes: Iterable[str] = [],
        preempted_outcomes: Iterable[str] = [],
        goal_key: str = "action_goal",
        feedback_key: str = "action_feedback",
        result_key: str = "action_result",
        goal_slots_map: Mapping[str, str] = {},
        feedback_slots_map: Mapping[str, str] = {},
        result_slots_map: Mapping[str, str] = {},
        expand_goal_slots: bool = False,
        pack_result_slots: bool = False,
    ) -> None:
        self.wrapped_container = wrapped_container
        wrapped_container.register_transition_cb(self.transition_cb)
        wrapped_container.register_termination_cb(self.termination_cb)
        self.userdata = smach.UserData()
        self._goal_key, self._feedback_key, self._result_key = goal_key, feedback_key, result_key
        self._goal_slots_map, self._result_slots_map = goal_slots_map, result_slots_map
        self._expand_goal_slots, self._pack_result_slots = expand_goal_slots, pack_result_slots
        empty = action_spec()
        self.userdata[goal_key] = copy.copy(empty.action_goal.goal)
        self.userdata[result_key] = copy.copy(empty.action_result.result)
        self.userdata[feedback_key] = copy.copy(empty.action_feedback.feedback)
        self._server_name = server_name
        self._action_server = SimpleActionServer(server_name, action_spec, execute_cb=self.execute_cb, auto_start=False)
        self._succeeded_outcomes = set(succeeded_outcomes)
        self._aborted_outcomes = set(aborted_outcomes)
        self._preempted_outcomes = set(preempted_outcomes)
        all_of_them = [self._succeeded_outcomes, self._aborted_outcomes, self._preempted_outcomes]
        if len(set().union(*all_of_them)) != sum(map(len, all_of_them)):
            rospy.logerr(
                "Succeeded, aborted, and preempted outcome lists were not mutually disjoint... expect undefined behavior."
            )

    def run_server(self) -> None:
        """Starts the server, and returns."""
        self._action_server.register_preempt_callback(self.preempt_cb)
        self._action_server.start()
        rospy.loginfo("Started SMACH action server wrapper, advertising as '%s'" % self._server_name)

    def transition_cb(self, userdata: Any, active_states: Any) -> None:
        """The container has gone to another state: its feedback is published."""
        self.publish_feedback(userdata)

    def termination_cb(self, userdata: Any, terminal_states: Any, container_outcome: Any) -> None:
        """The container has ended."""
        rospy.logdebug(
            "Wrapped state machine has terminated with final state: %s and container outcome: %s"
            % (terminal_states, container_outcome)
        )

    def publish_feedback(self, userdata: Any) -> None:
        """Publishes what userdata has as feedback."""
        if self._feedback_key in userdata:
            self._action_server.publish_feedback(userdata[self._feedback_key])

    def execute_cb(self, goal: Any) -> None:
        """A goal is to be worked at."""
        rospy.logdebug("Starting wrapped SMACH container")
        if self._expand_goal_slots:
            for slot in goal.__slots__:
                self.userdata[slot] = getattr(goal, slot)
        self.userdata[self._goal_key] = goal
        for slot, key in self._goal_slots_map.items():
            self.userdata[key] = getattr(goal, slot)
        container = self.wrapped_container
        try:
            keys = container.get_registered_input_keys(), container.get_registered_output_keys()
            outcome = container.execute(smach.Remapper(self.userdata, *keys, {}))
        except smach.InvalidUserCodeError:
            rospy.logerr("Exception thrown while executing wrapped container.")
            self._action_server.set_aborted()
            return
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            rospy.logerr("Exception thrown:while executing wrapped container: " + trace())
            self._action_server.set_aborted()
            return
        self._finish(outcome, self._result())

    def _result(self) -> Any:
        result = self.userdata[self._result_key]
        for slot, key in self._result_slots_map.items():
            setattr(result, slot, self.userdata[key])
        if self._pack_result_slots:
            for slot in result.__slots__:
                if slot in self.userdata:
                    setattr(result, slot, self.userdata[slot])
        return result

    def _finish(self, outcome: Any, result: Any) -> None:
        if outcome in self._succeeded_outcomes:
            rospy.loginfo("SUCCEEDED")
            self._action_server.set_succeeded(result)
        elif outcome in self._preempted_outcomes:
            rospy.loginfo("PREEMPTED")
            self._action_server.set_preempted(result)
        else:
            rospy.loginfo("ABORTED")
            self._action_server.set_aborted(result)

    def preempt_cb(self) -> None:
        """A client asks for the end of the goal."""
        rospy.loginfo("Preempt on state machine requested!")
        self.wrapped_container.request_preempt()
