"""Refused at its use: what the command `ros2` is made of."""

from rclpy import _stand_ins

_stand_ins.install(__name__, "ask the node for topics and services", ("node", "node.direct", "node.strategy"))
