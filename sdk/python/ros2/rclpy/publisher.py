"""Publishers."""

from __future__ import annotations

from rclpy import _matching, _world
from rclpy._rclpy_pybind11 import InvalidHandle
from rclpy.duration import Duration
from rclpy.qos import options_of
from rclpy.type_support import name_of

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class Publisher:
    """Publishes messages on a topic."""

    def __init__(self, node: Any, msg_type: Any, topic: str, full_name: str, qos_profile: Any, callbacks: Any) -> None:
        type_name = name_of(msg_type, "Message")
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.event_handlers: list[Any] = []
        self._node = node
        self._encode = self._first_encode
        self._full_name = full_name
        self._port = _world.open_port("publisher", full_name, type_name, **options_of(qos_profile))
        self._send = self._port.publish
        self._is_destroyed = False
        self._callbacks = callbacks
        _matching.opened(self)

    def publish(self, msg: Any) -> None:
        """Sends a message to all who have subscribed."""
        if isinstance(msg, self.msg_type):
            self._send(self._encode(msg).encode("ascii"))
        elif isinstance(msg, bytes):
            _world.unsupported("publishing a serialized message", "publish an object of the message's class")
        else:
            raise TypeError("Expected %s, got %s" % (self.msg_type, type(msg)))

    def _first_encode(self, msg: Any) -> str:
        codec = self.msg_type._codec_
        text: str = codec.encode(msg)
        self._encode = codec.encode  # which is compiled by now
        return text

    def get_subscription_count(self) -> int:
        """How many have subscribed, in all programs."""
        return _world.count("subscriber", self._full_name)

    @property
    def topic_name(self) -> str:
        """The full name of the topic."""
        return self._full_name

    def assert_liveliness(self) -> None:
        """There is nothing to do: publishers live as long as their programs."""

    def wait_for_all_acked(self, timeout: Duration | None = None) -> bool:
        """Always true: no message is lost."""
        return True

    def destroy(self) -> None:
        """Publishes no more."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._send = _refuse
            _matching.closed(self)
            _world.close(self._port)


def _refuse(message: bytes) -> None:
    raise InvalidHandle("cannot use Destroyable because destruction was requested")
