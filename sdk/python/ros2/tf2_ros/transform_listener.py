"""`TransformListener`: a buffer hears what is published of frames."""

from __future__ import annotations

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_AUTHORITY = "default_authority"


class TransformListener:
    """Subscribes to `/tf` and `/tf_static` for a buffer; with `spin_thread`, a thread of its own runs the node."""

    def __init__(
        self, buffer: Any, node: Any, *, spin_thread: bool = False, qos: Any = None, static_qos: Any = None
    ) -> None:
        if qos is None:
            qos = _profile(DurabilityPolicy.VOLATILE)
        if static_qos is None:
            static_qos = _profile(DurabilityPolicy.TRANSIENT_LOCAL)
        self.buffer = buffer
        self.node = node
        self.group = ReentrantCallbackGroup()  # so that others of the node's callbacks can wait for what it hears
        self.tf_sub = node.create_subscription(TFMessage, "/tf", self.callback, qos, callback_group=self.group)
        self.tf_static_sub = node.create_subscription(
            TFMessage, "/tf_static", self.static_callback, static_qos, callback_group=self.group
        )
        if spin_thread:
            from threading import Thread

            self.executor = SingleThreadedExecutor()
            self.dedicated_listener_thread = Thread(target=self._run)
            self.dedicated_listener_thread.start()

    def _run(self) -> None:
        self.executor.add_node(self.node)
        try:
            self.executor.spin()
        except ExternalShutdownException:
            pass
        self.executor.remove_node(self.node)

    def unregister(self) -> None:
        """Hears no more."""
        self.node.destroy_subscription(self.tf_sub)
        self.node.destroy_subscription(self.tf_static_sub)

    def callback(self, data: Any) -> None:
        """Where frames were at a time."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, _AUTHORITY)

    def static_callback(self, data: Any) -> None:
        """Where frames are at all times."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, _AUTHORITY)


def _profile(durability: DurabilityPolicy) -> QoSProfile:
    return QoSProfile(depth=100, durability=durability, history=HistoryPolicy.KEEP_LAST)
