"""Refused: services of loggers."""

from rclpy import _world

_world.unsupported("rclpy.logging_service", "use set_level of the logger")
