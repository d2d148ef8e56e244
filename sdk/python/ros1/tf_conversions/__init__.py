"""What programs mostly take from tf_conversions: `tf_conversions.transformations`. Conversions to PyKDL are refused."""

from __future__ import annotations

from tf import transformations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["transformations"]

_OF_KDL = ("fromTf", "toTf", "fromMsg", "toMsg", "fromMatrix", "toMatrix", "fromCameraParams")


def __getattr__(name: str) -> Any:
    if name not in _OF_KDL:
        raise AttributeError("module 'tf_conversions' has no attribute %r" % name)

    def missing(*args: Any, **kwargs: Any) -> Any:
        raise NotImplementedError(
            "tf_conversions.%s, which needs PyKDL, is not there in hrdsl: compute with tf.transformations, or transform"
            " messages by tf2_geometry_msgs" % name
        )

    return missing
