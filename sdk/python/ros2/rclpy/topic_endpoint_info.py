"""What is known of a publisher or a subscription."""

from __future__ import annotations

from enum import IntEnum

from rclpy.qos import HistoryPolicy, QoSProfile, qos_profile_unknown

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class TopicEndpointTypeEnum(IntEnum):
    """What it is."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


class TopicEndpointInfo:
    """A publisher or a subscription."""

    def __init__(
        self,
        *,
        node_name: str = "",
        node_namespace: str = "",
        topic_type: str = "",
        endpoint_type: TopicEndpointTypeEnum = TopicEndpointTypeEnum.INVALID,
        endpoint_gid: list[int] | None = None,
        qos_profile: QoSProfile | None = None,
    ) -> None:
        self.node_name = node_name
        self.node_namespace = node_namespace
        self.topic_type = topic_type
        self.endpoint_type = endpoint_type
        self.endpoint_gid = endpoint_gid or []
        self.qos_profile: Any = qos_profile_unknown if qos_profile is None else qos_profile

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TopicEndpointInfo) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        profile = self.qos_profile
        history = profile.history.name
        if profile.history == HistoryPolicy.KEEP_LAST:
            history += " (%d)" % profile.depth
        lines = {
            "Node name": self.node_name,
            "Node namespace": self.node_namespace,
            "Topic type": self.topic_type,
            "Endpoint type": self.endpoint_type.name,
            "GID": ".".join("%02x" % byte for byte in self.endpoint_gid),
            "QoS profile": "",
            "  Reliability": profile.reliability.name,
            "  History (Depth)": history,
            "  Durability": profile.durability.name,
            "  Lifespan": profile.lifespan,
            "  Deadline": profile.deadline,
            "  Liveliness": profile.liveliness.name,
            "  Liveliness lease duration": profile.liveliness_lease_duration,
        }
        return "\n".join(("%s: %s" % line).rstrip() for line in lines.items())
