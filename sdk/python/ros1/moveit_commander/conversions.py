"""Poses as messages and as lists."""

from __future__ import annotations

from moveit_commander.exception import MoveItCommanderException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Sequence


def pose_to_list(pose_msg: Any) -> list[float]:
    """[x, y, z, qx, qy, qz, qw] of a `Pose`."""
    at, turned = pose_msg.position, pose_msg.orientation
    return [at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w]


def numbers(pose: Sequence[float]) -> list[float]:
    """[x, y, z, qx, qy, qz, qw] of a list of 7, or of 6: [x, y, z, roll, pitch, yaw]."""
    given = [float(number) for number in pose]
    if len(given) == 6:
        from hrdsl.frames import rigid

        return given[:3] + list(rigid.quaternion(*given[3:]))
    if len(given) != 7:
        raise MoveItCommanderException("Expected either 6 or 7 elements in list: (x,y,z,r,p,y) or (x,y,z,qx,qy,qz,qw)")
    return given


def list_to_pose(pose_list: Sequence[float]) -> Any:
    """A `Pose` of a list of 6 or 7."""
    from geometry_msgs.msg import Pose

    made = Pose()
    at, turned = made.position, made.orientation
    at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w = numbers(pose_list)
    return made


def list_to_pose_stamped(pose_list: Sequence[float], target_frame: str) -> Any:
    """A `PoseStamped` of a list of 6 or 7, now."""
    import rospy
    from geometry_msgs.msg import PoseStamped

    made = PoseStamped()
    made.pose = list_to_pose(pose_list)
    made.header.frame_id = target_frame
    made.header.stamp = rospy.Time.now()
    return made


def transform_to_list(trf_msg: Any) -> list[float]:
    """[x, y, z, qx, qy, qz, qw] of a `Transform`."""
    moved, turned = trf_msg.translation, trf_msg.rotation
    return [moved.x, moved.y, moved.z, turned.x, turned.y, turned.z, turned.w]


def list_to_transform(trf_list: Sequence[float]) -> Any:
    """A `Transform` of a list of 7."""
    from geometry_msgs.msg import Transform

    made = Transform()
    moved, turned = made.translation, made.rotation
    moved.x, moved.y, moved.z, turned.x, turned.y, turned.z, turned.w = trf_list
    return made


def is_message(value: Any, name: str) -> bool:
    """Whether it is a message of this type, which need not be imported for that."""
    return getattr(type(value), "_type", None) == name
