"""Refused: introspection of services."""

from rclpy import _world

_world.unsupported("rclpy.service_introspection", "log in the service's callback")
