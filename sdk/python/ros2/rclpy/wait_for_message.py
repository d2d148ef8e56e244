"""Waiting for one message without an executor."""

from __future__ import annotations

from rclpy import _world
from rclpy._bell import Bell
from rclpy.type_support import name_of
from rclpy.utilities import timeout_sec_to_nsec

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


def wait_for_message(
    msg_type: Any, node: Any, topic: str, *, qos_profile: Any = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """The next message of a topic: True and the message, or False and None when the time is over or the context ends."""
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile)
    bell = Bell()
    subscription._wake = bell.ring
    nanos = timeout_sec_to_nsec(time_to_wait)
    _world.awaits("subscriber", subscription.topic_name, name_of(msg_type, "Message"), None if nanos < 0 else nanos / 1e9)
    try:
        node.context._wait(None if nanos < 0 else _world.now() + nanos, bell)
        if subscription._waiting and node.context.is_open():
            return True, subscription._next()[0]
        return False, None
    finally:
        node.destroy_subscription(subscription)
