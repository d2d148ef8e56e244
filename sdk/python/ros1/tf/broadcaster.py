"""`TransformBroadcaster`: tells where frames are."""

from __future__ import annotations

from geometry_msgs.msg import TransformStamped
from tf2_ros.broadcasters import TransformBroadcaster as _Broadcaster

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Sequence


class TransformBroadcaster:
    """Publishes to `/tf`."""

    def __init__(self, queue_size: int = 100) -> None:
        self.tf2_broadcaster = _Broadcaster()

    def sendTransform(self, translation: Sequence[float], rotation: Sequence[float], time: Any, child: str, parent: str) -> None:
        """Tells that `child` was there, as seen from `parent`; the rotation is (x, y, z, w)."""
        sent = TransformStamped()
        sent.header.frame_id = parent
        sent.header.stamp = time
        sent.child_frame_id = child
        moved, turned = sent.transform.translation, sent.transform.rotation
        moved.x, moved.y, moved.z = (float(translation[axis]) for axis in range(3))
        turned.x, turned.y, turned.z, turned.w = (float(rotation[axis]) for axis in range(4))
        self.sendTransformMessage(sent)

    def sendTransformMessage(self, transform: Any) -> None:
        """Tells the same by a message."""
        self.tf2_broadcaster.sendTransform([transform])
