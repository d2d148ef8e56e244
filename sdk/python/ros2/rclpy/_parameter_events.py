"""The topic `/parameter_events`. It has a publisher from when somebody listens: what is published before is lost anyway."""

from __future__ import annotations

from rclpy import _world

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

TOPIC = "/parameter_events"


def tell(node: Any, news: list[Any], changes: list[Any], gone: list[Any]) -> None:
    """Publishes what has become of a node's parameters."""
    if not _world.count("subscriber", TOPIC):
        return
    from rcl_interfaces.msg import ParameterEvent

    from rclpy.qos import qos_profile_parameter_events

    if node._parameter_events_ is None:
        node._parameter_events_ = node.create_publisher(ParameterEvent, TOPIC, qos_profile_parameter_events)
    node._parameter_events_.publish(
        ParameterEvent(
            stamp=node.get_clock().now().to_msg(),
            node=node.get_fully_qualified_name(),
            new_parameters=[each.to_parameter_msg() for each in news],
            changed_parameters=[each.to_parameter_msg() for each in changes],
            deleted_parameters=[each.to_parameter_msg() for each in gone],
        )
    )
