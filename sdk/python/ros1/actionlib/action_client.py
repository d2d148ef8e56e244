"""`ActionClient`: gives goals to a server, several at a time if it likes, and follows each of them."""

from __future__ import annotations

import time
import weakref

import rospy
from actionlib import _wire
from actionlib._lanes import Lane
from actionlib_msgs.msg import GoalID, GoalStatus
from hrdsl.exchange import the_exchange

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    Callback = Callable[..., Any] | None


def get_name_of_constant(C: Any, n: int) -> str:
    """The name of a value among the constants of a class."""
    for name, value in C.__dict__.items():
        if type(value) is int and value == n:
            return str(name)
    return "NO_SUCH_STATE_%d" % n


class CommState:
    """What the client knows of a goal."""

    WAITING_FOR_GOAL_ACK = 0
    PENDING = 1
    ACTIVE = 2
    WAITING_FOR_RESULT = 3
    WAITING_FOR_CANCEL_ACK = 4
    RECALLING = 5
    PREEMPTING = 6
    DONE = 7
    LOST = 8

    to_string = classmethod(get_name_of_constant)


class TerminalState:
    """How a goal can end."""

    RECALLED = GoalStatus.RECALLED
    REJECTED = GoalStatus.REJECTED
    PREEMPTED = GoalStatus.PREEMPTED
    ABORTED = GoalStatus.ABORTED
    SUCCEEDED = GoalStatus.SUCCEEDED
    LOST = GoalStatus.LOST

    to_string = classmethod(get_name_of_constant)


GoalStatus.to_string = classmethod(get_name_of_constant)

#: How the protocol calls ends.
_ENDS = {
    "succeeded": GoalStatus.SUCCEEDED,
    "aborted": GoalStatus.ABORTED,
    "canceled": GoalStatus.PREEMPTED,
    "rejected": GoalStatus.REJECTED,
}

_ENDED = set(_ENDS.values()) | {GoalStatus.RECALLED, GoalStatus.LOST}

#: The protocol does not tell that a server has accepted a goal: it is taken to have so many nanoseconds after it was sent,
#: if it has neither rejected nor ended it.
_ACCEPTED_AFTER = 1_000_000


def _steps(state: int, status: int) -> tuple[int, ...]:
    """Through which states a goal goes when the server says its status: all that lie between are told, too."""
    if status == GoalStatus.ACTIVE:
        return (CommState.ACTIVE,) if state <= CommState.PENDING else ()
    begun: tuple[int, ...] = () if state > CommState.PENDING else (CommState.ACTIVE,)
    if status == GoalStatus.REJECTED:
        begun = (CommState.PENDING,) if state == CommState.WAITING_FOR_GOAL_ACK else ()
    stopping = status in (GoalStatus.PREEMPTING, GoalStatus.PREEMPTED)
    if status != GoalStatus.REJECTED and (stopping or state == CommState.WAITING_FOR_CANCEL_ACK):
        begun += () if state == CommState.PREEMPTING else (CommState.PREEMPTING,)
    return begun + ((CommState.WAITING_FOR_RESULT,) if status in _ENDED else ())


class CommStateMachine:
    """A goal that was sent."""

    def __init__(self, client: ActionClient, action_goal: Any, transition_cb: Callback, feedback_cb: Callback) -> None:
        self.client = client
        self.action_goal = action_goal
        self.transition_cb = transition_cb
        self.feedback_cb = feedback_cb
        self.call: Any = None  # of the protocol, once it is sent
        self.state = CommState.WAITING_FOR_GOAL_ACK
        self.latest_goal_status = GoalStatus(goal_id=action_goal.goal_id, status=GoalStatus.PENDING)
        self.latest_result: Any = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CommStateMachine) and self.action_goal.goal_id.id == other.action_goal.goal_id.id

    def __hash__(self) -> int:
        return hash(self.action_goal.goal_id.id)

    def transition_to(self, state: int) -> None:
        """Goes on, and tells the program."""
        rospy.logdebug(
            "Transitioning to %s (from %s, goal: %s)",
            CommState.to_string(state),
            CommState.to_string(self.state),
            self.action_goal.goal_id.id,
        )
        self.state = state
        if self.transition_cb:
            self.transition_cb(ClientGoalHandle(self))

    def update_status(self, status: int) -> None:
        """The server says what it does with the goal."""
        if self.state == CommState.DONE:
            return
        steps = _steps(self.state, status)
        if steps or status in _ENDED:
            self.latest_goal_status = GoalStatus(goal_id=self.action_goal.goal_id, status=status)
        for state in steps:
            self.transition_to(state)

    def update_result(self, status: int, action_result: Any) -> None:
        """The goal has ended."""
        if self.state == CommState.DONE:
            rospy.logerr("Got a result when we were already in the DONE state")
            return
        self.latest_result = action_result
        self.update_status(status)
        action_result.status = self.latest_goal_status
        self.transition_to(CommState.DONE)

    def update_feedback(self, feedback: Any) -> None:
        """The server tells how it gets on."""
        if self.feedback_cb and self.state != CommState.DONE:
            self.feedback_cb(ClientGoalHandle(self), feedback)


class ClientGoalHandle:
    """A goal that was sent, as the program has it."""

    def __init__(self, comm_state_machine: CommStateMachine) -> None:
        self.comm_state_machine = comm_state_machine

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self.comm_state_machine == other.comm_state_machine

    def __hash__(self) -> int:
        return hash(self.comm_state_machine)

    def cancel(self) -> None:
        """Asks the server to end the goal."""
        machine = self.comm_state_machine
        machine.call.cancel()
        if machine.state == CommState.DONE:
            return  # the goal cannot come back to life
        was = machine.state
        machine.transition_to(CommState.WAITING_FOR_CANCEL_ACK)
        if was != CommState.WAITING_FOR_GOAL_ACK:
            machine.client._statuses.put(weakref.ref(machine), GoalStatus.PREEMPTING)

    def get_comm_state(self) -> int:
        """What the client knows of the goal (`CommState`)."""
        the_exchange().polled("goal")
        return self.comm_state_machine.state

    def get_goal_status(self) -> int:
        """What the server said last (`GoalStatus`)."""
        the_exchange().polled("goal")
        status: int = self.comm_state_machine.latest_goal_status.status
        return status

    def get_goal_status_text(self) -> str:
        """The server's explanation, which the protocol does not carry: always empty."""
        return str(self.comm_state_machine.latest_goal_status.text)

    def get_result(self) -> Any:
        """The result; None before there is one."""
        the_exchange().polled("goal")
        result = self.comm_state_machine.latest_result
        return None if result is None else result.result

    def get_terminal_state(self) -> int:
        """How the goal has ended (`TerminalState`)."""
        machine = self.comm_state_machine
        if machine.state != CommState.DONE:
            rospy.logwarn("Asking for the terminal state when we're in [%s]", CommState.to_string(machine.state))
        status: int = machine.latest_goal_status.status
        if status in _ENDED:
            return status
        rospy.logerr("Asking for a terminal state, but the goal status is %d", status)
        return int(GoalStatus.LOST)


class ActionClient:
    """Gives goals to the server of a name. It can be made before the node is."""

    _sent = 0

    def __init__(self, ns: str, ActionSpec: Any) -> None:
        self.ns = ns
        self.ActionSpec = ActionSpec
        self._spec = _wire.Spec(ActionSpec)
        self.ActionGoal = self._spec.action_goal
        self.ActionResult = self._spec.action_result
        self.ActionFeedback = self._spec.action_feedback
        self._name: str = rospy.resolve_name(ns)
        self._port: Any = None
        self._open: dict[int, tuple[Any, Any]] = {}  # calls that have not ended, with the times of their goals
        self._statuses: Any = None
        rospy.core.when_initialized(self._connect)

    def _connect(self) -> None:
        self._port = the_exchange().open("action_client", self._name, self._spec.type)

    def _begin(self) -> None:
        # Not before they are needed: many programs make clients that they seldom use.
        self._statuses = Lane(self._name + "/status", self._status_cb)
        self._results = Lane(self._name + "/result", self._result_cb)
        self._feedbacks = Lane(self._name + "/feedback", self._feedback_cb)

    def stop(self) -> None:
        """Gives no goals any more, and hears nothing of those that it gave."""
        if self._port is not None:
            self._port.close()
        self._open.clear()

    def send_goal(self, goal: Any, transition_cb: Callback = None, feedback_cb: Callback = None) -> ClientGoalHandle:
        """Gives a goal. Calls `transition_cb(handle)` when its state changes, `feedback_cb(handle, feedback)` when the
        server tells something, each kind in a thread of its own."""
        if self._port is None:
            raise rospy.ROSException("ROS node has not been initialized yet. Please call init_node() first")
        if self._statuses is None:
            self._begin()
        message = _wire.encode(goal, self._spec.goal, self._name)
        machine = CommStateMachine(self, self._action_goal(goal), transition_cb, feedback_cb)
        # Who drops all handles of a goal hears no more of it, as ever.
        kept = weakref.ref(machine)
        machine.call = self._port.call(message, lambda arrival: self._hear(kept(), arrival))
        self._open[machine.call.number] = machine.call, machine.action_goal.goal_id.stamp
        if _wire.the_servers().has(self._name):
            self._statuses.put(kept, GoalStatus.ACTIVE)
        return ClientGoalHandle(machine)

    def _action_goal(self, goal: Any) -> Any:
        ActionClient._sent += 1
        now = rospy.Time.now()
        whole = self.ActionGoal()
        whole.header.stamp = now
        whole.goal_id = GoalID(stamp=now, id="%s-%i-%.3f" % (rospy.get_caller_id(), ActionClient._sent, now.to_sec()))
        whole.goal = goal
        return whole

    def _hear(self, machine: CommStateMachine | None, arrival: dict[str, Any]) -> None:
        # Called while all threads of the program wait: it only hands on.
        if "feedback" not in arrival:
            self._open.pop(arrival.get("finished", arrival.get("answered", 0)), None)
        if machine is None:
            return
        if "feedback" in arrival:
            if machine.state <= CommState.PENDING:  # then it has been accepted
                self._statuses.put(weakref.ref(machine), GoalStatus.ACTIVE)
            self._feedbacks.put(machine, arrival["message"])
        elif "finished" in arrival:
            self._results.put(machine, arrival)
        # Else nobody has got the goal, or who had it has gone: in ROS, too, the client is not told.

    def _status_cb(self, kept: Callable[[], CommStateMachine | None], status: int) -> None:
        machine = kept()
        if machine is None:
            return
        if status == GoalStatus.ACTIVE:
            sent = machine.action_goal.goal_id.stamp.to_nsec()
            del machine
            left = sent + _ACCEPTED_AFTER - rospy.Time.now().to_nsec()
            if left > 0:
                time.sleep(left / 1e9)
            machine = kept()
        if machine is not None:
            machine.update_status(status)

    def _result_cb(self, machine: CommStateMachine, arrival: dict[str, Any]) -> None:
        action_result = self.ActionResult()
        action_result.header.stamp = rospy.Time.now()
        action_result.result = _wire.decode(arrival["message"], self._spec.result)
        machine.update_result(_ENDS[arrival["end"]], action_result)

    def _feedback_cb(self, machine: CommStateMachine, message: Any) -> None:
        machine.update_feedback(_wire.decode(message, self._spec.feedback))

    def cancel_all_goals(self) -> None:
        """Asks the server to end all goals that this client gave. (Those of other clients go on: the protocol lets
        nobody cancel what another has asked for.)"""
        for call, _ in list(self._open.values()):
            call.cancel()

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Asks the server to end those that were given until then."""
        for call, stamp in list(self._open.values()):
            if stamp <= time:
                call.cancel()

    def wait_for_server(self, timeout: Any = rospy.Duration(0.0)) -> bool:
        """Waits until there is a server, at most for a `rospy.Duration`; zero is for ever."""
        return _wire.the_servers().wait(self._name, timeout)

    def wait_for_action_server_to_start(self, timeout: Any = rospy.Duration(0.0)) -> bool:
        """The former name of `wait_for_server`."""
        return self.wait_for_server(timeout)
