"""Refused: nodes with a life cycle."""

from rclpy import _world

_world.unsupported("rclpy.lifecycle", "use rclpy.node.Node, and do in its constructor what on_configure and on_activate do")
