"""Subscriptions."""

from __future__ import annotations

from collections import deque
from types import FunctionType, MethodType

from rclpy import _matching, _world
from rclpy.qos import options_of
from rclpy.type_support import decoded, name_of

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class Subscription:
    """Calls a callback with each message of a topic."""

    def __init__(
        self,
        node: Any,
        msg_type: Any,
        topic: str,
        full_name: str,
        callback: Callable[..., Any],
        callback_group: Any,
        qos_profile: Any,
        callbacks: Any,
    ) -> None:
        type_name = name_of(msg_type, "Message")
        self.msg_type = msg_type
        self.topic = topic
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self.raw = False
        self.event_handlers: list[Any] = []
        self._executor_event = False
        self._is_destroyed = False
        self._node = node
        self._codec_ = msg_type._codec_
        self._full_name = full_name
        self._type_name = type_name
        self._wake: Callable[[], None] = node._wake_executor
        options = options_of(qos_profile)
        self._waiting: deque[tuple[Any, int]] = deque(maxlen=options["depth"])
        self._wants_info = _wants_info(callback)
        self._port = _world.open_port("subscriber", full_name, type_name, self._arrived, **options)
        self._callbacks = callbacks
        _matching.opened(self)

    def _arrived(self, arrival: dict[str, Any]) -> None:
        self._waiting.append((arrival["message"], _world.now()))
        self._wake()

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting)

    def _next(self) -> tuple[Any, int]:
        value, time = self._waiting.popleft()
        return decoded(self._codec_, value, "topic %s (%s)" % (self._full_name, self._type_name)), time

    def _take(self) -> tuple[Any, tuple[Any, ...]] | None:
        if not self._waiting:
            return None
        message, time = self._next()
        if not self._wants_info:
            return self.callback, (message,)
        nanos = _world.EPOCH + time
        return self.callback, (message, {"source_timestamp": nanos, "received_timestamp": nanos})

    def get_publisher_count(self) -> int:
        """How many publish, in all programs."""
        return _world.count("publisher", self._full_name)

    @property
    def topic_name(self) -> str:
        """The full name of the topic."""
        return self._full_name

    def destroy(self) -> None:
        """Nothing arrives any more."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._waiting.clear()
            _matching.closed(self)
            _world.close(self._port)


def _wants_info(callback: Any) -> bool:
    """Whether a callback needs a second argument, which tells when the message was sent."""
    bound = 0
    while isinstance(callback, MethodType):
        callback, bound = callback.__func__, bound + 1
    if not isinstance(callback, FunctionType):
        return False
    return callback.__code__.co_argcount - len(callback.__defaults__ or ()) - bound == 2
