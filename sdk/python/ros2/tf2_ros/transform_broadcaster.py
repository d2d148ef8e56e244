"""`TransformBroadcaster`: who tells where frames are at a time."""

from __future__ import annotations

from rclpy.qos import QoSProfile
from tf2_msgs.msg import TFMessage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TransformBroadcaster:
    """Publishes to `/tf` where frames were at a time."""

    def __init__(self, node: Any, qos: Any = None) -> None:
        self.pub_tf = node.create_publisher(TFMessage, "/tf", QoSProfile(depth=100) if qos is None else qos)

    def sendTransform(self, transform: Any) -> None:
        """Tells of one `TransformStamped`, or of several."""
        self.pub_tf.publish(TFMessage(transforms=list(transform) if hasattr(transform, "__iter__") else [transform]))
