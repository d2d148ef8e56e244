"""How messages of geometry_msgs are brought into another frame. The original needs NumPy; this does not."""

from __future__ import annotations

import tf2_ros
from geometry_msgs.msg import (
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Vector3Stamped,
    WrenchStamped,
)
from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "PointStamped",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "Vector3Stamped",
    "do_transform_point",
    "do_transform_polygon_stamped",
    "do_transform_pose",
    "do_transform_pose_stamped",
    "do_transform_pose_with_covariance_stamped",
    "do_transform_vector3",
    "do_transform_wrench",
    "from_msg_msg",
    "to_msg_msg",
    "transform_covariance",
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


def _move(point: Any, transform: Any, into: Any) -> None:
    into.x, into.y, into.z = rigid.place(*_place(transform), (point.x, point.y, point.z))


def _turn(vector: Any, transform: Any, into: Any) -> None:
    into.x, into.y, into.z = rigid.place((0.0, 0.0, 0.0), _place(transform)[1], (vector.x, vector.y, vector.z))


def do_transform_point(point: Any, transform: Any) -> Any:
    """The `PointStamped` as seen from the transform's frame."""
    made = PointStamped(header=transform.header)
    _move(point.point, transform, made.point)
    return made


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """The `Vector3Stamped`, turned."""
    made = Vector3Stamped(header=transform.header)
    _turn(vector3.vector, transform, made.vector)
    return made


def do_transform_wrench(wrench: Any, transform: Any) -> Any:
    """The `WrenchStamped`, turned."""
    made = WrenchStamped(header=transform.header)
    _turn(wrench.wrench.force, transform, made.wrench.force)
    _turn(wrench.wrench.torque, transform, made.wrench.torque)
    return made


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """The `Pose` as seen from the transform's frame."""
    made = Pose()
    _move(pose.position, transform, made.position)
    own, turned = pose.orientation, made.orientation
    q = rigid.from_rows(rigid.rows(rigid.multiply(_place(transform)[1], (own.x, own.y, own.z, own.w))))
    turned.x, turned.y, turned.z, turned.w = q if q[3] >= 0 else tuple(-number for number in q)
    return made


def do_transform_pose_stamped(pose: Any, transform: Any) -> Any:
    """The `PoseStamped` as seen from the transform's frame."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def transform_covariance(cov_in: Any, transform: Any) -> Any:
    """The covariance of a pose, six rows of six, turned."""
    turn = rigid.rows(_place(transform)[1])
    made = [0.0] * 36
    for row in range(6):
        for column in range(6):
            top, left = row - row % 3, column - column % 3
            made[6 * row + column] = sum(
                turn[row % 3][i] * float(cov_in[6 * (top + i) + left + j]) * turn[column % 3][j]
                for i in range(3)
                for j in range(3)
            )
    return made


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """The `PoseWithCovarianceStamped` as seen from the transform's frame."""
    made = PoseWithCovarianceStamped(header=transform.header)
    made.pose.pose = do_transform_pose(pose.pose.pose, transform)
    made.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return made


def do_transform_polygon_stamped(polygon: Any, transform: Any) -> Any:
    """The `PolygonStamped` as seen from the transform's frame."""
    made = PolygonStamped(header=transform.header)
    for point in polygon.polygon.points:
        moved = type(point)()
        _move(point, transform, moved)
        made.polygon.points.append(moved)
    return made


for _kind in (Vector3Stamped, PoseStamped, PointStamped):
    tf2_ros.ConvertRegistration().add_to_msg(_kind, to_msg_msg)
    tf2_ros.ConvertRegistration().add_from_msg(_kind, from_msg_msg)
for _kind, _change in (
    (PointStamped, do_transform_point),
    (Vector3Stamped, do_transform_vector3),
    (WrenchStamped, do_transform_wrench),
    (PoseStamped, do_transform_pose_stamped),
    (PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped),
    (PolygonStamped, do_transform_polygon_stamped),
):
    tf2_ros.TransformRegistration().add(_kind, _change)
