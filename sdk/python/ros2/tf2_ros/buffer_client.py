"""Refused: transforms that another node computes, or that are computed for others."""

from __future__ import annotations

from rclpy import _world
from tf2_ros.buffer_interface import BufferInterface

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class BufferClient(BufferInterface):
    """Refused."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        _world.unsupported("tf2_ros.BufferClient", "make a tf2_ros.Buffer and a tf2_ros.TransformListener instead")


class BufferServer:
    """Refused."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        _world.unsupported("tf2_ros.BufferServer", "give each node a tf2_ros.Buffer and a tf2_ros.TransformListener instead")
