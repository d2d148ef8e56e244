"""Frames and where they are, with the interface of ROS 1's tf."""

from tf2_ros import ConnectivityException, ExtrapolationException, LookupException
from tf2_ros import TransformException as Exception
from tf import transformations
from tf.listener import Transformer, TransformerROS, TransformListener
from tf.broadcaster import TransformBroadcaster

__all__ = [
    "ConnectivityException",
    "Exception",
    "ExtrapolationException",
    "LookupException",
    "TransformBroadcaster",
    "TransformListener",
    "Transformer",
    "TransformerROS",
    "transformations",
]
