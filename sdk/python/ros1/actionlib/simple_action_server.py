"""`SimpleActionServer`: works at one goal at a time; a later one asks for the end of the one before."""

from __future__ import annotations

import threading

import rospy
from actionlib.action_server import ActionServer, nop_cb
from actionlib.server_goal_handle import ServerGoalHandle
from actionlib_msgs.msg import GoalStatus
from hrdsl.exchange import the_exchange

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

__all__ = ["SimpleActionServer", "nop_cb"]

_REPLACED = "This goal was canceled because another goal was received by the simple action server"

#: After a goal, the thread that executes them sleeps for so long before it looks for the next, unless one comes.
_PAUSE = 0.1


class SimpleActionServer:
    """Calls `execute_cb(goal)` for each goal, in a thread of its own; or, without it, lets the program accept goals
    (`accept_new_goal`) when it is told of them (`register_goal_callback`) or looks (`is_new_goal_available`)."""

    def __init__(
        self, name: str, ActionSpec: Any, execute_cb: Callable[[Any], Any] | None = None, auto_start: bool = True
    ) -> None:
        self._name = name
        self.new_goal = False
        self.preempt_request = False
        self.new_goal_preempt_request = False
        self.execute_callback = execute_cb
        self.goal_callback: Callable[[], Any] | None = None
        self.preempt_callback: Callable[[], Any] | None = None
        self.need_to_terminate = False
        # Whoever takes both takes that of the action server first.
        self.lock = threading.RLock()
        self.execute_condition = threading.Condition(self.lock)
        self.current_goal = ServerGoalHandle()
        self.next_goal = ServerGoalHandle()
        self.execute_thread: threading.Thread | None = None
        self.action_server = ActionServer(name, ActionSpec, self.internal_goal_callback, self.internal_preempt_callback, False)
        if execute_cb:
            rospy.core.add_shutdown_hook(self._wake)
            self.execute_thread = threading.Thread(target=self.executeLoop)
            self.execute_thread.start()
        if auto_start:
            rospy.logwarn(
                "You've passed in true for auto_start to the python action server, you should always pass in false to"
                " avoid race conditions."
            )
            self.start()

    def start(self) -> None:
        """From now on there is a server of this name."""
        self.action_server.start()

    # ── what the program asks ──

    def accept_new_goal(self) -> Any:
        """Takes the next goal on, which ends the one before, and returns it; None if there is none."""
        with self.action_server.lock, self.lock:
            if not self.new_goal or not self.next_goal.get_goal():
                rospy.logerr("Attempting to accept the next goal when a new goal is not available")
                return None
            if self._is_active() and self.current_goal.get_goal() and self.current_goal != self.next_goal:
                self.current_goal.set_canceled(None, _REPLACED)
            rospy.logdebug("Accepting a new goal")
            self.current_goal = self.next_goal
            self.new_goal = False
            self.preempt_request = self.new_goal_preempt_request
            self.new_goal_preempt_request = False
            self.current_goal.set_accepted("This goal has been accepted by the simple action server")
            return self.current_goal.get_goal()

    def is_new_goal_available(self) -> bool:
        """Whether a goal waits to be accepted."""
        the_exchange().polled("goal")
        return self.new_goal

    def is_preempt_requested(self) -> bool:
        """Whether somebody asks for the end of the present goal."""
        the_exchange().polled("goal")
        return self.preempt_request

    def is_active(self) -> bool:
        """Whether a goal is worked at."""
        the_exchange().polled("goal")
        return self._is_active()

    def _is_active(self) -> bool:
        if not self.current_goal.get_goal():
            return False
        status = self.current_goal.get_goal_status().status
        return bool(status == GoalStatus.ACTIVE or status == GoalStatus.PREEMPTING)

    # ── what the program says ──

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """The present goal is reached."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_succeeded(result or self.get_default_result(), text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """The present goal cannot be reached."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_aborted(result or self.get_default_result(), text)

    def set_preempted(self, result: Any = None, text: str = "") -> None:
        """The present goal was given up because somebody asked for it."""
        with self.action_server.lock, self.lock:
            rospy.logdebug("Setting the current goal as canceled")
            self.current_goal.set_canceled(result or self.get_default_result(), text)

    def publish_feedback(self, feedback: Any) -> None:
        """Tells the client of the present goal how it gets on."""
        self.current_goal.publish_feedback(feedback)

    def get_default_result(self) -> Any:
        """An empty result."""
        return self.action_server.ActionResultType()

    def register_goal_callback(self, cb: Callable[[], Any]) -> None:
        """Calls `cb()` when a goal has come; only without `execute_cb`."""
        if self.execute_callback:
            rospy.logwarn(
                "Cannot call SimpleActionServer.register_goal_callback() because an executeCallback exists. Not going to"
                " register it."
            )
        else:
            self.goal_callback = cb

    def register_preempt_callback(self, cb: Callable[[], Any]) -> None:
        """Calls `cb()` when somebody asks for the end of the present goal, or another comes."""
        self.preempt_callback = cb

    # ── in the server's threads ──

    def internal_goal_callback(self, goal: ServerGoalHandle) -> None:
        """A goal has come."""
        with self.execute_condition:
            try:
                rospy.logdebug("A new goal %s has been received by the single goal action server", goal.get_goal_id().id)
                waits = self.next_goal.get_goal() and (not self.current_goal.get_goal() or self.next_goal != self.current_goal)
                if waits:
                    self.next_goal.set_canceled(None, _REPLACED)
                self.next_goal = goal
                self.new_goal = True
                self.new_goal_preempt_request = False
                if self._is_active():
                    self.preempt_request = True
                    if self.preempt_callback:
                        self.preempt_callback()
                if self.goal_callback:
                    self.goal_callback()
                self.execute_condition.notify()
            except Exception as error:
                rospy.logerr("SimpleActionServer.internal_goal_callback - exception %s", str(error))
                rospy.core.failed("callback for a new goal of %s" % self._name, error)

    def internal_preempt_callback(self, preempt: ServerGoalHandle) -> None:
        """Somebody asks for the end of a goal."""
        with self.lock:
            rospy.logdebug("A preempt has been received by the SimpleActionServer")
            if preempt == self.current_goal:
                rospy.logdebug("Setting preempt_request bit for the current goal to TRUE and invoking callback")
                self.preempt_request = True
                if self.preempt_callback:
                    self.preempt_callback()
            elif preempt == self.next_goal:
                rospy.logdebug("Setting preempt request bit for the next goal to TRUE")
                self.new_goal_preempt_request = True

    def _wake(self, reason: str) -> None:
        with self.execute_condition:
            self.execute_condition.notify_all()

    def executeLoop(self) -> None:
        """Executes the goals, until the node is shut down."""
        pause: float | None = None
        while not rospy.is_shutdown() and not self.need_to_terminate:
            if self._is_active():
                rospy.logerr("Should never reach this code with an active goal")
                return
            if self.new_goal:
                self._execute(self.accept_new_goal())
                pause = _PAUSE
            with self.execute_condition:
                if pause is not None or not (self.new_goal or rospy.is_shutdown()):
                    self.execute_condition.wait(pause)
            pause = None

    def _execute(self, goal: Any) -> None:
        assert self.execute_callback is not None
        try:
            self.execute_callback(goal)
            if self._is_active():
                rospy.logwarn(
                    "Your executeCallback did not set the goal to a terminal status.  This is a bug in your ActionServer"
                    " implementation. Fix your code!  For now, the ActionServer will set this goal to aborted"
                )
                self.set_aborted(None, "No terminal state was set.")
        except Exception as error:
            import traceback

            rospy.logerr("Exception in your execute callback: %s\n%s", str(error), traceback.format_exc())
            self.set_aborted(None, "Exception in execute callback: %s" % str(error))
