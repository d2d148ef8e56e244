"""Frames and where they are, with the interface of ROS 1's tf2_ros."""

from __future__ import annotations

from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)
from tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener
from tf2_ros.broadcasters import StaticTransformBroadcaster, TransformBroadcaster

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "Buffer",
    "BufferCore",
    "BufferServer",
    "BufferInterface",
    "ConnectivityException",
    "ConvertRegistration",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "NotImplementedException",
    "Stamped",
    "StaticTransformBroadcaster",
    "TimeoutException",
    "TransformBroadcaster",
    "TransformException",
    "TransformListener",
    "TransformRegistration",
    "TypeException",
    "convert",
]


class BufferClient:
    """Refused."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise NotImplementedError(
            "tf2_ros.BufferClient, which asks a server of transforms, is not there in hrdsl: make a tf2_ros.Buffer and a"
            " tf2_ros.TransformListener instead"
        )


class BufferServer:
    """Refused."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise NotImplementedError(
            "tf2_ros.BufferServer, which answers other nodes about transforms, is not there in hrdsl: give each node a tf2_ros.Buffer and a"
            " tf2_ros.TransformListener instead"
        )
