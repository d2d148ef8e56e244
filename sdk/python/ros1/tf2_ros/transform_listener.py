"""`TransformListener`: a buffer hears what is published of frames."""

from __future__ import annotations

import rospy
from tf2_msgs.msg import TFMessage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TransformListener:
    """Subscribes to `/tf` and `/tf_static` for a buffer."""

    def __init__(self, buffer: Any, queue_size: int | None = None, buff_size: int = 65536, tcp_nodelay: bool = False) -> None:
        self.buffer = buffer
        self.tf_sub = rospy.Subscriber("/tf", TFMessage, self.callback, queue_size=queue_size)
        self.tf_static_sub = rospy.Subscriber("/tf_static", TFMessage, self.static_callback, queue_size=queue_size)

    def unregister(self) -> None:
        """Hears no more."""
        self.tf_sub.unregister()
        self.tf_static_sub.unregister()

    def callback(self, data: Any) -> None:
        """Where frames were at a time."""
        who = _author(data)
        for transform in data.transforms:
            self.buffer.set_transform(transform, who)

    def static_callback(self, data: Any) -> None:
        """Where frames are at all times."""
        who = _author(data)
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, who)


def _author(data: Any) -> str:
    header = getattr(data, "_connection_header", None) or {}
    return str(header.get("callerid", "default_authority"))
