"""Those who tell where frames are."""

from __future__ import annotations

import rospy
from tf2_msgs.msg import TFMessage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TransformBroadcaster:
    """Publishes to `/tf` where frames were at a time."""

    def __init__(self) -> None:
        self.pub_tf = rospy.Publisher("/tf", TFMessage, queue_size=100)

    def sendTransform(self, transform: Any) -> None:
        """Tells of one `TransformStamped`, or of a list of them."""
        self.pub_tf.publish(TFMessage(transform if isinstance(transform, list) else [transform]))


class StaticTransformBroadcaster:
    """Publishes to `/tf_static` where frames are at all times; who listens later hears it, too."""

    def __init__(self) -> None:
        self.pub_tf = rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)

    def sendTransform(self, transform: Any) -> None:
        """Tells of one `TransformStamped`, or of a list of them. (As ever, the last list is what later listeners hear.)"""
        self.pub_tf.publish(TFMessage(transform if isinstance(transform, list) else [transform]))
