"""Servers of actions."""

from __future__ import annotations

import traceback
from collections import deque
from enum import Enum

from rclpy import _world
from rclpy._rclpy_pybind11 import GoalEvent as GoalEvent
from rclpy._rclpy_pybind11 import RCLError as RCLError
from rclpy.action import _goals
from rclpy.executors import await_or_execute
from rclpy.type_support import decoded, name_of
from rclpy.waitable import Waitable

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class GoalResponse(Enum):
    """What a callback says of a goal."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """What a callback says of a request to cancel one."""

    REJECT = 1
    ACCEPT = 2


#: What each event makes of a goal, by what it was.
_TRANSITIONS = {
    GoalEvent.EXECUTE: {_goals.ACCEPTED: _goals.EXECUTING},
    GoalEvent.CANCEL_GOAL: {_goals.ACCEPTED: _goals.CANCELING, _goals.EXECUTING: _goals.CANCELING},
    GoalEvent.SUCCEED: {_goals.EXECUTING: _goals.SUCCEEDED, _goals.CANCELING: _goals.SUCCEEDED},
    GoalEvent.ABORT: {_goals.EXECUTING: _goals.ABORTED, _goals.CANCELING: _goals.ABORTED},
    GoalEvent.CANCELED: {_goals.CANCELING: _goals.CANCELED},
}


class ServerGoalHandle:
    """A goal that was accepted."""

    def __init__(self, action_server: ActionServer, call: int, goal_request: Any) -> None:
        self._action_server = action_server
        self._call = call
        self._goal_request = goal_request
        self._id = _goals.new_id()
        self._goal_id: Any = None
        self._status = _goals.ACCEPTED

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self._id == other._id

    __hash__ = None  # type: ignore[assignment]

    @property
    def request(self) -> Any:
        """What is to be reached."""
        return self._goal_request

    @property
    def goal_id(self) -> Any:
        """Its identifier."""
        if self._goal_id is None:
            self._goal_id = _goals.uuid_message(self._id)
        return self._goal_id

    @property
    def is_active(self) -> bool:
        """Whether it has not ended."""
        return self._status in (_goals.ACCEPTED, _goals.EXECUTING, _goals.CANCELING)

    @property
    def is_cancel_requested(self) -> bool:
        """Whether it is to end before it is reached."""
        _world.looked("is_cancel_requested")
        return self._status == _goals.CANCELING

    @property
    def status(self) -> int:
        """What has become of it, as `action_msgs.msg.GoalStatus` has it."""
        return self._status

    def _update_state(self, event: GoalEvent) -> None:
        if self._status == _goals.UNKNOWN:
            return
        following = _TRANSITIONS[event].get(self._status)
        if following is None:
            raise RCLError(
                "Failed to update goal state: goal_handle attempted invalid transition from state %s with event %s"
                % (_goals.NAMES[self._status], event.name)
            )
        self._status = following

    def execute(self, execute_callback: Any = None) -> None:
        """Lets the callback run that reaches it."""
        if self._status != _goals.CANCELING:
            self._update_state(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Tells the client how far it is."""
        if not isinstance(feedback, self._action_server.action_type.Feedback):
            raise TypeError()
        if self._status != _goals.UNKNOWN:
            self._action_server._tell(self._call, feedback._codec_.encode(feedback).encode("ascii"))

    def succeed(self) -> None:
        """It is reached."""
        self._update_state(GoalEvent.SUCCEED)

    def abort(self) -> None:
        """It cannot be reached."""
        self._update_state(GoalEvent.ABORT)

    def canceled(self) -> None:
        """It has ended as was asked for."""
        self._update_state(GoalEvent.CANCELED)

    def destroy(self) -> None:
        """Forgets it."""
        self._status = _goals.UNKNOWN


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Begins at once."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accepts all goals."""
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:
    """Lets none be canceled."""
    return CancelResponse.REJECT


class ActionServer(Waitable):
    """Reaches goals by a callback."""

    def __init__(
        self,
        node: Any,
        action_type: Any,
        action_name: str,
        execute_callback: Any,
        *,
        callback_group: Any = None,
        goal_callback: Any = default_goal_callback,
        handle_accepted_callback: Any = default_handle_accepted_callback,
        cancel_callback: Any = default_cancel_callback,
        result_timeout: float = 900,
        **profiles: Any,
    ) -> None:
        super().__init__(callback_group or node.default_callback_group)
        type_name = name_of(action_type, "Action")
        self._node = node
        self._action_type = action_type
        self._full_name = node.resolve_topic_name(action_name)
        self._what = "action %s (%s)" % (self._full_name, type_name)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_goal_callback(goal_callback)
        self.register_cancel_callback(cancel_callback)
        self.register_execute_callback(execute_callback)
        self._goal_handles: dict[int, ServerGoalHandle] = {}
        self._waiting: deque[dict[str, Any]] = deque()
        self.callback = self._execute
        self._port = _world.open_port("action_server", self._full_name, type_name, self._arrived)
        node.add_waitable(self)

    @property
    def action_type(self) -> Any:
        """The class of the action."""
        return self._action_type

    # ── what the executor asks ──

    def _arrived(self, arrival: dict[str, Any]) -> None:
        self._waiting.append(arrival)
        self._node._wake_executor()

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting)

    def _is_async(self) -> bool:
        return True

    def _take(self) -> Any:
        return (self._execute, (self._waiting.popleft(),)) if self._waiting else None

    async def _execute(self, arrival: dict[str, Any]) -> None:
        if "called" in arrival:
            await self._judge(arrival["called"], arrival["message"])
        elif "canceled" in arrival:
            await self._cancel(arrival["canceled"])

    async def _judge(self, call: int, message: Any) -> None:
        request = decoded(self._action_type.Goal._codec_, message, self._what)
        logger = self._node.get_logger()
        response = await await_or_execute(self._goal_callback, request)
        if not isinstance(response, GoalResponse):
            logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
        if response is not GoalResponse.ACCEPT:
            self._finish(call, "rejected", self._action_type.Result())
            return
        handle = self._goal_handles[call] = ServerGoalHandle(self, call, request)
        _world.exchange().accept(call)
        await await_or_execute(self._handle_accepted_callback, handle)

    async def _cancel(self, call: int) -> None:
        handle = self._goal_handles.get(call)
        if handle is None:
            return
        response = await await_or_execute(self._cancel_callback, handle)
        granted = response is CancelResponse.ACCEPT and handle.is_active
        if granted and handle._status != _goals.CANCELING:
            handle._update_state(GoalEvent.CANCEL_GOAL)
        if call in self._goal_handles:
            _world.exchange().answer_cancel(call, granted)

    async def _execute_goal(self, execute_callback: Any, handle: ServerGoalHandle) -> None:
        logger = self._node.get_logger()
        try:
            result = await await_or_execute(execute_callback, handle)
        except Exception as error:
            result = self._action_type.Result()
            logger.error("Error raised in execute callback: %s" % error)
            traceback.print_exc()
        if handle.is_active:
            logger.warning("Goal state not set, assuming aborted. Goal ID: %s" % list(handle._id))
            handle.abort()
        if not isinstance(result, self._action_type.Result):
            name = self._action_type.Result.__name__
            raise AssertionError("The 'result' field must be a sub message of type '%s'" % name)
        if self._goal_handles.pop(handle._call, None) is not None:
            self._finish(handle._call, _goals.ENDS[handle._status], result)

    def _tell(self, call: int, message: bytes) -> None:
        if call in self._goal_handles:
            _world.exchange().feedback(call, message)

    def _finish(self, call: int, end: str, result: Any) -> None:
        _world.exchange().finish(call, end, result._codec_.encode(result).encode("ascii"))

    def notify_execute(self, goal_handle: ServerGoalHandle, execute_callback: Any) -> None:
        """Lets the executor run the callback."""
        callback = self._execute_callback if execute_callback is None else execute_callback
        if callback is not None:
            self._node.executor.create_task(self._execute_goal, callback, goal_handle)

    # ── callbacks ──

    def register_handle_accepted_callback(self, handle_accepted_callback: Any) -> None:
        """Calls it with each goal that was accepted; by default the goal is begun."""
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_goal_callback(self, goal_callback: Any) -> None:
        """Calls it with each goal; it returns a `GoalResponse`."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_cancel_callback(self, cancel_callback: Any) -> None:
        """Calls it with each goal that is to be canceled; it returns a `CancelResponse`."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    def register_execute_callback(self, execute_callback: Any) -> None:
        """Calls it to reach a goal; it returns the result."""
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def destroy(self) -> None:
        """Reaches no more goals."""
        if not self._is_destroyed:
            self._is_destroyed = True
            for handle in self._goal_handles.values():
                handle.destroy()
            self._goal_handles.clear()
            if self in self._node._waitables_:
                self._node.remove_waitable(self)
            _world.close(self._port)
