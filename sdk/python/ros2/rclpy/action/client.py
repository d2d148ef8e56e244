"""Clients of actions."""

from __future__ import annotations

import sys
import threading
import time
from collections import deque

from rclpy import _world
from rclpy.action import _goals
from rclpy.task import Future, is_coroutine_function
from rclpy.type_support import decoded, name_of
from rclpy.waitable import Waitable

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class _Goal:
    """A goal that was sent: what is known of it, and who waits to know."""

    def __init__(self, number: bytes, feedback: Any) -> None:
        self.id = number
        self.feedback = feedback
        self.call: Any = None
        self.sent = Future()
        self.handle: ClientGoalHandle | None = None
        self.end: tuple[int, Any] | None = None  # its status, and its result
        self.results: list[Future] = []
        self.cancels: list[Future] = []


class ClientGoalHandle:
    """A goal that was sent and answered."""

    def __init__(self, action_client: ActionClient, goal: _Goal, accepted: bool) -> None:
        self._action_client = action_client
        self._goal = goal
        self._accepted = accepted
        self._status = _goals.EXECUTING if accepted else _goals.UNKNOWN
        self._stamp = action_client._node.get_clock().now()
        self._goal_id: Any = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self._goal.id == other._goal.id

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "ClientGoalHandle <id=%s, accepted=%s, status=%d>" % (self.goal_id.uuid, self._accepted, self._status)

    @property
    def goal_id(self) -> Any:
        """Its identifier."""
        if self._goal_id is None:
            self._goal_id = _goals.uuid_message(self._goal.id)
        return self._goal_id

    @property
    def stamp(self) -> Any:
        """When it was accepted."""
        return self._stamp.to_msg()

    @property
    def accepted(self) -> bool:
        """Whether it was."""
        return self._accepted

    @property
    def status(self) -> int:
        """What has become of it, as `action_msgs.msg.GoalStatus` has it."""
        return self._status

    def cancel_goal(self) -> Any:
        """Asks for its end, and waits for the answer, while another thread spins the node."""
        return _waited(self.cancel_goal_async())

    def cancel_goal_async(self) -> Future:
        """Asks for its end; the future is done when that is answered."""
        return self._action_client._cancel(self._goal)

    def get_result(self) -> Any:
        """Waits for its end, while another thread spins the node."""
        return _waited(self.get_result_async())

    def get_result_async(self) -> Future:
        """A future that is done when the goal has ended: its result has a `status` and a `result`."""
        return self._action_client._result(self._goal)


def _waited(future: Future) -> Any:
    event = threading.Event()
    future.add_done_callback(lambda _: event.set())
    if not future._done:
        event.wait()
    error = future.exception()
    if error is not None:
        raise error
    return future.result()


class ActionClient(Waitable):
    """Gives goals to an action's server."""

    def __init__(
        self, node: Any, action_type: Any, action_name: str, *, callback_group: Any = None, **profiles: Any
    ) -> None:
        super().__init__(callback_group or node.default_callback_group)
        type_name = name_of(action_type, "Action")
        self._node = node
        self._action_type = action_type
        self._action_name = action_name
        self._full_name = node.resolve_topic_name(action_name)
        self._what = "action %s (%s)" % (self._full_name, type_name)
        self._waiting: deque[tuple[_Goal, dict[str, Any]]] = deque()
        self._ended: deque[_Goal] = deque()  # whose ends somebody asks for again
        self.callback = self._execute
        self._type_name = type_name
        self._port = _world.open_port("action_client", self._full_name, type_name)
        node.add_waitable(self)

    # ── asking ──

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Gives a goal and waits for its result, while another thread spins the node."""
        return _waited(_waited(self.send_goal_async(goal, **kwargs)).get_result_async())

    def send_goal_async(self, goal: Any, feedback_callback: Any = None, goal_uuid: Any = None) -> Future:
        """Gives a goal; the future is done when that is accepted or rejected, and its result is a `ClientGoalHandle`."""
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError()
        number = _goals.new_id() if goal_uuid is None else bytes(list(goal_uuid.uuid))
        made = _Goal(number, feedback_callback)

        def arrived(arrival: dict[str, Any]) -> None:
            self._waiting.append((made, arrival))
            self._node._wake_executor()

        made.call = self._port.call(goal._codec_.encode(goal).encode("ascii"), arrived)
        self.add_future(made.sent)
        made.sent.add_done_callback(self.remove_future)
        return made.sent

    def _answer_soon(self, goal: _Goal) -> None:
        self._ended.append(goal)
        self._due = _world.now()
        self._node._wake_executor()

    def _cancel(self, goal: _Goal) -> Future:
        future = Future()
        self.add_future(future)
        future.add_done_callback(self.remove_future)
        goal.cancels.append(future)
        if goal.end is None:
            goal.call.cancel()
        else:
            self._answer_soon(goal)
        return future

    def _result(self, goal: _Goal) -> Future:
        future = Future()
        self.add_future(future)
        future.add_done_callback(self.remove_future)
        goal.results.append(future)
        if goal.end is not None:
            self._answer_soon(goal)
        return future

    def server_is_ready(self) -> bool:
        """Whether there is a server."""
        return _world.count("action_server", self._full_name) > 0

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Looks every quarter of a second whether there is a server, until the timeout: whether there is."""
        left = float("inf") if timeout_sec is None else timeout_sec
        is_told = False
        while self._node.context.is_open() and not self.server_is_ready() and left > 0.0:
            if not is_told:
                is_told = True
                _world.awaits("action_client", self._full_name, self._type_name, left)
            time.sleep(0.25)
            left -= 0.25
        return self.server_is_ready()

    # ── what the executor asks ──

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting) or (self._is_quiet and bool(self._ended))

    def _is_async(self) -> bool:
        return True

    def _take(self) -> Any:
        if self._waiting:
            return self._execute, self._waiting.popleft()
        if self._ended:
            goal = self._ended.popleft()
            if not self._ended:
                self._due, self._is_quiet = None, False
            return self._execute, (goal, None)
        return None

    async def _execute(self, goal: _Goal, arrival: dict[str, Any] | None) -> None:
        for future in self._futures:
            future._set_executor(self._node.executor)
        if arrival is None:
            pass
        elif "accepted" in arrival:
            self._accept(goal)
        elif "feedback" in arrival:
            await self._hear(goal, arrival["message"])
        elif "cancel_answered" in arrival:
            self._answer_cancels(goal, arrival["granted"])
        elif "finished" in arrival:
            self._finish(goal, arrival)
        elif "error" in arrival:  # on a robot nothing would come
            told = "hrdsl: %s: a goal of %s is never answered: %s\n"
            sys.stderr.write(told % (self._what, self._node.get_name(), arrival["error"]))
        self._answer(goal)

    def _accept(self, goal: _Goal) -> None:
        if goal.handle is None:
            goal.handle = ClientGoalHandle(self, goal, True)
            goal.sent.set_result(goal.handle)

    async def _hear(self, goal: _Goal, message: Any) -> None:
        self._accept(goal)  # by a server that does not say so
        if goal.feedback is None:
            return
        feedback = decoded(self._action_type.Feedback._codec_, message, self._what)
        title = _goals.title(self._action_type, "FeedbackMessage")
        told = _goals.Told(title, goal_id=goal.handle.goal_id, feedback=feedback)  # type: ignore[union-attr]
        if is_coroutine_function(goal.feedback):
            await goal.feedback(told)
        else:
            goal.feedback(told)

    def _finish(self, goal: _Goal, arrival: dict[str, Any]) -> None:
        end, message = arrival["end"], arrival.get("message")
        if end == "rejected" and goal.handle is None:
            goal.end = _goals.UNKNOWN, self._action_type.Result()
            goal.handle = ClientGoalHandle(self, goal, False)
            goal.sent.set_result(goal.handle)
            return
        codec = self._action_type.Result._codec_
        result = self._action_type.Result() if message is None else decoded(codec, message, self._what)
        goal.end = _goals.STATES.get(end, _goals.UNKNOWN), result
        self._accept(goal)
        goal.handle._status = goal.end[0]  # type: ignore[union-attr]
        self._answer_cancels(goal, end == "canceled")

    def _answer(self, goal: _Goal) -> None:
        """Those who wait for what is known now."""
        if goal.end is not None:
            results, goal.results = goal.results, []
            title = _goals.title(self._action_type, "GetResult_Response")
            for future in results:
                future.set_result(_goals.Told(title, status=goal.end[0], result=goal.end[1]))
            self._answer_cancels(goal, False)

    def _answer_cancels(self, goal: _Goal, is_granted: bool) -> None:
        from action_msgs.msg import GoalInfo
        from action_msgs.srv import CancelGoal

        cancels, goal.cancels = goal.cancels, []
        if goal.handle is not None and is_granted and goal.end is None:
            goal.handle._status = _goals.CANCELING
        for future in cancels:
            response: Any = CancelGoal.Response()
            if is_granted:
                response.goals_canceling = [GoalInfo(goal_id=_goals.uuid_message(goal.id))]
            else:
                response.return_code = response.ERROR_REJECTED if goal.end is None else response.ERROR_GOAL_TERMINATED
            future.set_result(response)

    def destroy(self) -> None:
        """Gives no more goals."""
        if not self._is_destroyed:
            self._is_destroyed = True
            if self in self._node._waitables_:
                self._node.remove_waitable(self)
            _world.close(self._port)
