"""Callbacks for events of the middleware. Of these events there is one here: profiles that do not fit together."""

from __future__ import annotations

from rclpy import _world
from rclpy._rclpy_pybind11 import UnsupportedEventTypeError as UnsupportedEventTypeError

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class QoSRequestedIncompatibleQoSInfo:
    """What a callback is told of profiles that do not fit together."""

    def __init__(self, total_count: int, last_policy_kind: int) -> None:
        self.total_count = total_count
        self.total_count_change = 1
        self.last_policy_kind = last_policy_kind


QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo


class _EventCallbacks:
    def __init__(self, incompatible_qos: Any, use_default_callbacks: bool, others: dict[str, Any]) -> None:
        self.incompatible_qos = incompatible_qos
        self.use_default_callbacks = use_default_callbacks
        for name, callback in others.items():
            if callback is not None:
                _world.unsupported("the event callback %r" % name, "such an event never happens in simulated time")
            setattr(self, name, None)


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks of a subscription."""

    def __init__(
        self,
        *,
        deadline: Any = None,
        incompatible_qos: Any = None,
        liveliness: Any = None,
        message_lost: Any = None,
        incompatible_type: Any = None,
        matched: Any = None,
        use_default_callbacks: bool = True,
    ) -> None:
        others = {"deadline": deadline, "liveliness": liveliness, "message_lost": message_lost}
        super().__init__(incompatible_qos, use_default_callbacks, {**others, "matched": matched})


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks of a publisher."""

    def __init__(
        self,
        *,
        deadline: Any = None,
        liveliness: Any = None,
        incompatible_qos: Any = None,
        incompatible_type: Any = None,
        matched: Any = None,
        use_default_callbacks: bool = True,
    ) -> None:
        others = {"deadline": deadline, "liveliness": liveliness, "matched": matched}
        super().__init__(incompatible_qos, use_default_callbacks, others)
