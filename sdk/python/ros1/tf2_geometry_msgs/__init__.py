"""How messages of geometry_msgs are brought into another frame. The original needs PyKDL; this does not."""

from __future__ import annotations

import tf2_ros
from geometry_msgs.msg import PointStamped, PoseStamped, Vector3Stamped, WrenchStamped
from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "PointStamped",
    "PoseStamped",
    "Vector3Stamped",
    "WrenchStamped",
    "do_transform_point",
    "do_transform_pose",
    "do_transform_vector3",
    "do_transform_wrench",
    "from_msg_msg",
    "to_msg_msg",
]


def to_msg_msg(msg: Any) -> Any:
    """A message is one."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """A message is one."""
    return msg


def _place(transform: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    moved, turned = transform.transform.translation, transform.transform.rotation
    return (moved.x, moved.y, moved.z), (turned.x, turned.y, turned.z, turned.w)


def do_transform_point(point: Any, transform: Any) -> Any:
    """The `PointStamped` as seen from the transform's frame."""
    made = PointStamped()
    given = point.point.x, point.point.y, point.point.z
    made.point.x, made.point.y, made.point.z = rigid.place(*_place(transform), given)
    made.header = transform.header
    return made


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """The `Vector3Stamped`, turned."""
    made = Vector3Stamped()
    given = vector3.vector.x, vector3.vector.y, vector3.vector.z
    rotation = _place(transform)[1]
    made.vector.x, made.vector.y, made.vector.z = rigid.place((0.0, 0.0, 0.0), rotation, given)
    made.header = transform.header
    return made


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """The `PoseStamped` as seen from the transform's frame."""
    made = PoseStamped()
    translation, rotation = _place(transform)
    at, own = pose.pose.position, pose.pose.orientation
    placed, turned = made.pose.position, made.pose.orientation
    placed.x, placed.y, placed.z = rigid.place(translation, rotation, (at.x, at.y, at.z))
    q = rigid.multiply(rotation, (own.x, own.y, own.z, own.w))
    turned.x, turned.y, turned.z, turned.w = rigid.from_rows(rigid.rows(q))
    made.header = transform.header
    return made


def do_transform_wrench(wrench: Any, transform: Any) -> Any:
    """The `WrenchStamped`, turned."""
    made = WrenchStamped()
    for part in ("force", "torque"):
        vector = Vector3Stamped()
        vector.vector = getattr(wrench.wrench, part)
        setattr(made.wrench, part, do_transform_vector3(vector, transform).vector)
    made.header = transform.header
    return made


for _kind in (Vector3Stamped, PoseStamped, PointStamped):
    tf2_ros.ConvertRegistration().add_to_msg(_kind, to_msg_msg)
    tf2_ros.ConvertRegistration().add_from_msg(_kind, from_msg_msg)
tf2_ros.TransformRegistration().add(PointStamped, do_transform_point)
tf2_ros.TransformRegistration().add(Vector3Stamped, do_transform_vector3)
tf2_ros.TransformRegistration().add(PoseStamped, do_transform_pose)
tf2_ros.TransformRegistration().add(WrenchStamped, do_transform_wrench)
