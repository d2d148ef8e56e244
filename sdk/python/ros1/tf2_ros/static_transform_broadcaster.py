"""`StaticTransformBroadcaster`, where programs import it from."""

from tf2_ros.broadcasters import StaticTransformBroadcaster

__all__ = ["StaticTransformBroadcaster"]
