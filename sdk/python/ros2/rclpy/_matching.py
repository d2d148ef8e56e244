"""Publishers and subscriptions of this program whose profiles do not fit together: on a robot no message would pass."""

from __future__ import annotations

from rclpy.qos import incompatible_policy
from rclpy.qos_event import QoSRequestedIncompatibleQoSInfo

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

_ends: dict[str, list[Any]] = {}  # by topic


def opened(end: Any) -> None:
    """A publisher or a subscription is there: those that do not fit it are told, and it is told of them."""
    ends = _ends.setdefault(end.topic_name, [])
    is_publisher = hasattr(end, "publish")
    for other in ends:
        if hasattr(other, "publish") == is_publisher:
            continue
        publisher, subscription = (end, other) if is_publisher else (other, end)
        policy = incompatible_policy(publisher.qos_profile, subscription.qos_profile)
        if policy is not None:
            text = "New publisher discovered on topic '%s', offering incompatible QoS. No messages will be received from it."
            _tell(subscription, policy, text)
            text = "New subscription discovered on topic '%s', requesting incompatible QoS. No messages will be sent to it."
            _tell(publisher, policy, text)
    ends.append(end)


def closed(end: Any) -> None:
    """It is there no more."""
    ends = _ends.get(end.topic_name, [])
    if end in ends:
        ends.remove(end)


def _tell(end: Any, policy: Any, text: str) -> None:
    callbacks = end._callbacks
    if callbacks is not None and callbacks.incompatible_qos is not None:
        callbacks.incompatible_qos(QoSRequestedIncompatibleQoSInfo(1, policy))
    elif callbacks is None or callbacks.use_default_callbacks:
        logger = end._node.get_logger()
        logger.warning("%s Last incompatible policy: %s" % (text % end.topic, policy.name))
