"""`StaticTransformBroadcaster`: who tells where frames are at all times."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class StaticTransformBroadcaster:
    """Publishes to `/tf_static` where frames are at all times; who listens later hears it, too."""

    def __init__(self, node: Any, qos: Any = None) -> None:
        if qos is None:
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=HistoryPolicy.KEEP_LAST)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)

    def sendTransform(self, transform: Any) -> None:
        """Tells of one `TransformStamped`, or of several. (As in Humble, the last of these is what later listeners hear.)"""
        self.pub_tf.publish(TFMessage(transforms=list(transform) if hasattr(transform, "__iter__") else [transform]))
