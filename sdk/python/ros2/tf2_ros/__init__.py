"""Refused: transforms over topics."""

raise NotImplementedError(
    "tf2_ros is not supported by hrdsl's rclpy: "
    "publish and subscribe to what you need of them yourself for now"
)
