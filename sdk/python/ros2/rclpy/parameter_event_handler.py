"""Refused: ParameterEventHandler."""

from rclpy import _world

_world.unsupported("rclpy.parameter_event_handler", "subscribe to /parameter_events")
