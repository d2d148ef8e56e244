"""`TransformBroadcaster`, where programs import it from."""

from tf2_ros.broadcasters import TransformBroadcaster

__all__ = ["TransformBroadcaster"]
