"""Refused: AsyncParameterClient."""

from rclpy import _world

_world.unsupported("rclpy.parameter_client", "call the node's services, such as /NODE/get_parameters")
