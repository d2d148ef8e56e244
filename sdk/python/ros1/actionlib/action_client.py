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

#: How the protocol calls the ends of goals that were accepted.
_ENDS = {
    "succeeded": GoalStatus.SUCCEEDED,
    "aborted": GoalStatus.ABORTED,
    "canceled": GoalStatus.PREEMPTED,
    "rejected": GoalStatus.REJECTED,
}

_ENDED = set(_ENDS.values()) | {GoalStatus.RECALLED, GoalStatus.LOST}

#: Statuses of goals that were never accepted.
_NEVER_ACTIVE = (GoalStatus.REJECTED, GoalStatus.RECALLING, GoalStatus.RECALLED)

#: A server of ROS 1 tells five times a second which goals it has: after so many nanoseconds a client knows that it has got
#: one which it has neither accepted nor rejected.
_KNOWN_AFTER = 200_000_000


def _steps(state: int, status: int) -> tuple[int, ...] | None:
    """Through which states a goal goes when the server says its status: all that lie between are told, too. None: no goal of
    this state can get such a status."""
    if state in (CommState.WAITING_FOR_RESULT, CommState.DONE):
        return ()
    if status == GoalStatus.PENDING:
        return (CommState.PENDING,) if state == CommState.WAITING_FOR_GOAL_ACK else ()
    if status == GoalStatus.ACTIVE:
        return (CommState.ACTIVE,) if state <= CommState.PENDING else ()
    steps: list[int] = []
    if status in _NEVER_ACTIVE:
        if state in (CommState.ACTIVE, CommState.PREEMPTING):
            return None
        if state == CommState.WAITING_FOR_GOAL_ACK:
            steps.append(CommState.PENDING)
        recalls = status == GoalStatus.RECALLING or (
            status == GoalStatus.RECALLED and state != CommState.WAITING_FOR_GOAL_ACK
        )
        if recalls and state != CommState.RECALLING:
            steps.append(CommState.RECALLING)
    else:
        if state <= CommState.PENDING:
            steps.append(CommState.ACTIVE)
        stops = status in (GoalStatus.PREEMPTING, GoalStatus.PREEMPTED)
        if state != CommState.PREEMPTING and (stops or state >= CommState.WAITING_FOR_CANCEL_ACK):
            steps.append(CommState.PREEMPTING)
    if status in _ENDED:
        steps.append(CommState.WAITING_FOR_RESULT)
    return tuple(steps)


class CommStateMachine:
    """A goal that was sent."""

    def __init__(self, client: ActionClient, action_goal: Any, transition_cb: Callback, feedback_cb: Callback) -> None:
        self.client = client
        self.action_goal = action_goal
        self.transition_cb = transition_cb
        self.feedback_cb = feedback_cb
        self.call: Any = None  # of the protocol, once it is sent
        self.is_lost = False  # nobody has got it
        self.is_accepted = False
        self.is_canceling = False
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

    def update_status(self, status: int, text: str = "") -> None:
        """The server says what it does with the goal."""
        if self.state == CommState.DONE:
            return
        self.latest_goal_status = GoalStatus(goal_id=self.action_goal.goal_id, status=status, text=text)
        steps = _steps(self.state, status)
        if steps is None:
            rospy.logerr(
                "Invalid goal status transition from %s to %s"
                % (CommState.to_string(self.state), GoalStatus.to_string(status))
            )
        for state in steps or ():
            self.transition_to(state)

    def update_result(self, status: int, text: str, action_result: Any) -> None:
        """The goal has ended."""
        if self.state == CommState.DONE:
            rospy.logerr("Got a result when we were already in the DONE state")
            return
        self.latest_result = action_result
        self.update_status(status, text)
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
        if machine.state != CommState.DONE:  # else the goal cannot come back to life
            machine.transition_to(CommState.WAITING_FOR_CANCEL_ACK)

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
        """What the server said with the status."""
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
        self._news = Lane(self._name + "/goal", self._known_cb)
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
        self._news.put(kept)
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
        if "finished" in arrival or "answered" in arrival:
            self._open.pop(arrival.get("finished", arrival.get("answered", 0)), None)
        if machine is None:
            return
        text = arrival.get("text", "")
        if "accepted" in arrival:
            machine.is_accepted = True
            self._statuses.put(weakref.ref(machine), self._running(machine), text)
        elif "feedback" in arrival:
            if not machine.is_accepted:  # by a server that does not say so
                machine.is_accepted = True
                self._statuses.put(weakref.ref(machine), self._running(machine), text)
            self._feedbacks.put(machine, arrival["message"])
        elif "cancel_answered" in arrival:
            if arrival["granted"]:
                machine.is_canceling = True
                self._statuses.put(weakref.ref(machine), self._running(machine), text)
        elif "finished" in arrival:
            self._results.put(machine, arrival)
        else:  # nobody has got the goal, or who had it has gone: in ROS, too, the client is not told
            machine.is_lost = True

    @staticmethod
    def _running(machine: CommStateMachine) -> int:
        """The status of a goal that has not ended."""
        if machine.is_accepted:
            return int(GoalStatus.PREEMPTING if machine.is_canceling else GoalStatus.ACTIVE)
        return int(GoalStatus.RECALLING if machine.is_canceling else GoalStatus.PENDING)

    def _status_cb(self, kept: Callable[[], CommStateMachine | None], status: int, text: str) -> None:
        machine = kept()
        if machine is not None:
            machine.update_status(status, text)

    def _known_cb(self, kept: Callable[[], CommStateMachine | None]) -> None:
        machine = kept()
        if machine is None:
            return
        known = machine.action_goal.goal_id.stamp.to_nsec() + _KNOWN_AFTER
        del machine  # so that a goal whose handle nobody keeps is forgotten meanwhile
        left = known - rospy.Time.now().to_nsec()
        if left > 0:
            time.sleep(left / 1e9)
        machine = kept()
        if machine is not None and machine.state == CommState.WAITING_FOR_GOAL_ACK and not machine.is_lost:
            machine.update_status(GoalStatus.PENDING)

    def _result_cb(self, machine: CommStateMachine, arrival: dict[str, Any]) -> None:
        action_result = self.ActionResult()
        action_result.header.stamp = rospy.Time.now()
        action_result.result = _wire.decode(arrival["message"], self._spec.result)
        status = _ENDS[arrival["end"]]
        if status == GoalStatus.PREEMPTED and not machine.is_accepted:
            status = GoalStatus.RECALLED
        machine.update_result(status, arrival.get("text", ""), action_result)

    def _feedback_cb(self, machine: CommStateMachine, message: Any) -> None:
        machine.update_feedback(_wire.decode(message, self._spec.feedback))

    def cancel_all_goals(self) -> None:
        """Asks the server to end all goals that it has, those of other clients, too."""
        self._port.cancel_all()

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Asks the server to end those that this client gave until then."""
        for call, stamp in list(self._open.values()):
            if stamp <= time:
                call.cancel()

    def wait_for_server(self, timeout: Any = rospy.Duration(0.0)) -> bool:
        """Waits until there is a server, at most for a `rospy.Duration`; zero is for ever."""
        return _wire.the_servers().wait(self._name, self._spec.type, timeout)

    def wait_for_action_server_to_start(self, timeout: Any = rospy.Duration(0.0)) -> bool:
        """The former name of `wait_for_server`."""
        return self.wait_for_server(timeout)
