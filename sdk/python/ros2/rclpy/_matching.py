"""Publishers and subscriptions whose profiles do not fit together: no message passes between them, and both are told.

Whether reliability and durability fit, the harness decides, over all programs; of the other policies it is looked here, among
the ends of this program, and messages pass all the same.
"""

from __future__ import annotations

from collections import deque

from rclpy.qos import QoSPolicyKind, incompatible_policy
from rclpy.qos_event import QoSRequestedIncompatibleQoSInfo
from rclpy.waitable import Waitable

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

_OF_PUBLISHER = "New subscription discovered on topic '%s', requesting incompatible QoS. No messages will be sent to it."
_OF_SUBSCRIPTION = "New publisher discovered on topic '%s', offering incompatible QoS. No messages will be received from it."

_ends: dict[str, list[Any]] = {}  # of this program, by topic


class _MismatchEvents(Waitable):
    """What one end is told of others that do not fit it, when its node is spun."""

    def __init__(self, end: Any) -> None:
        super().__init__(end._node.default_callback_group)
        self._end, self._port = end, end._port
        self._waiting: deque[QoSPolicyKind] = deque()
        self._total = 0
        self.callback = self._tell
        end._node.add_waitable(self)

    def put(self, policy: QoSPolicyKind) -> None:
        """One more does not fit."""
        self._waiting.append(policy)
        self._end._node._wake_executor()

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting)

    def _is_async(self) -> bool:
        return False

    def _take(self) -> Any:
        return (self._tell, (self._waiting.popleft(),)) if self._waiting else None

    def _tell(self, policy: QoSPolicyKind) -> None:
        end, callbacks = self._end, self._end._callbacks
        self._total += 1
        if callbacks is not None and callbacks.incompatible_qos is not None:
            callbacks.incompatible_qos(QoSRequestedIncompatibleQoSInfo(self._total, policy))
        elif callbacks is None or callbacks.use_default_callbacks:
            text = (_OF_PUBLISHER if _is_publisher(end) else _OF_SUBSCRIPTION) % end.topic
            end._node.get_logger().warning("%s Last incompatible policy: %s" % (text, policy.name))

    def destroy(self) -> None:
        """It is told nothing more."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._end._node.remove_waitable(self)


def _is_publisher(end: Any) -> bool:
    return bool(end._port.kind == "publisher")


def opened(end: Any) -> None:
    """A publisher or a subscription is there: those that do not fit it are told, and it is told of them."""
    end._port.on_incompatible = lambda policy: _mismatched(end, QoSPolicyKind[policy.upper()])
    ends = _ends.setdefault(end.topic_name, [])
    for other in ends:
        if _is_publisher(other) == _is_publisher(end):
            continue
        publisher, subscription = (end, other) if _is_publisher(end) else (other, end)
        policy = incompatible_policy(publisher.qos_profile, subscription.qos_profile)
        if policy not in (None, QoSPolicyKind.RELIABILITY, QoSPolicyKind.DURABILITY):
            for each in (subscription, publisher):
                _mismatched(each, policy)
    ends.append(end)


def closed(end: Any) -> None:
    """It is there no more."""
    ends = _ends.get(end.topic_name, [])
    if end in ends:
        ends.remove(end)
    if end.event_handlers:
        end.event_handlers.pop().destroy()


def _mismatched(end: Any, policy: QoSPolicyKind) -> None:
    if not end.event_handlers:
        end.event_handlers.append(_MismatchEvents(end))
    end.event_handlers[0].put(policy)
