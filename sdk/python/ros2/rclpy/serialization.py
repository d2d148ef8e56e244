"""Refused: messages as bytes."""

from rclpy import _world

_world.unsupported("rclpy.serialization", "messages are no bytes in simulated time; keep the objects")
