"""`TransformListener`: hears where frames are, and says so of any two of them at any time."""

from __future__ import annotations

import geometry_msgs.msg
import tf2_ros
from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Place = tuple[list[float], list[float]]


def strip_leading_slash(s: str) -> str:
    """The name of a frame as it is kept."""
    return s[1:] if s.startswith("/") else s


class Transformer:
    """Frames by what the program itself says of them (`setTransform`)."""

    def __init__(self, interpolate: bool = True, cache_time: Any = None) -> None:
        self._buffer = tf2_ros.Buffer(cache_time, debug=False)
        self._using_dedicated_thread = False

    def allFramesAsString(self) -> str:
        """All frames with their parents, a line for each."""
        return self._buffer.all_frames_as_string()

    def allFramesAsDot(self, current_time: Any = None) -> str:
        """All frames as a graph for Graphviz."""
        return self._buffer._allFramesAsDot(current_time)

    def setTransform(self, transform: Any, authority: str = "default_authority") -> None:
        """Takes a `geometry_msgs.msg.TransformStamped`."""
        self._buffer.set_transform(transform, authority)

    def canTransform(self, target_frame: str, source_frame: str, time: Any) -> int:
        """Whether `lookupTransform` knows, as 1 or 0."""
        target, source = strip_leading_slash(target_frame), strip_leading_slash(source_frame)
        found: int = self._buffer.can_transform(target, source, time)
        return found

    def canTransformFull(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> int:
        """Whether `lookupTransformFull` knows, as 1 or 0."""
        target, source, fixed = map(strip_leading_slash, (target_frame, source_frame, fixed_frame))
        found: int = self._buffer.can_transform_full(target, target_time, source, source_time, fixed)
        return found

    def waitForTransform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any, polling_sleep_duration: Any = None
    ) -> None:
        """Waits until `lookupTransform` knows; raises after the timeout."""
        self._check_thread()
        target, source = strip_leading_slash(target_frame), strip_leading_slash(source_frame)
        found: Any = self._buffer.can_transform(target, source, time, timeout, return_debug_tuple=True)
        self._check_found(found, target_frame, source_frame)

    def waitForTransformFull(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any,
        polling_sleep_duration: Any = None,
    ) -> None:
        """Waits until `lookupTransformFull` knows; raises after the timeout."""
        self._check_thread()
        target, source, fixed = map(strip_leading_slash, (target_frame, source_frame, fixed_frame))
        found: Any = self._buffer.can_transform_full(
            target, target_time, source, source_time, fixed, timeout, return_debug_tuple=True
        )
        self._check_found(found, target_frame, source_frame)

    def _check_thread(self) -> None:
        if not self._using_dedicated_thread:
            raise tf2_ros.TransformException(
                "cannot wait for transform without a dedicated thread that listens to incoming TF messages"
            )

    def _check_found(self, found: tuple[bool, str], target_frame: str, source_frame: str) -> None:
        if not found[0]:
            missing = 'no such transformation: "%s" -> "%s"' % (source_frame, target_frame)
            raise tf2_ros.TransformException(found[1] or missing)

    def chain(self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str) -> Any:
        """The frames on the way from one to the other."""
        return self._buffer._chain(target_frame, target_time, source_frame, source_time, fixed_frame)

    def clear(self) -> None:
        """Forgets where frames are."""
        self._buffer.clear()

    def frameExists(self, frame_id: str) -> bool:
        """Whether something was heard of the frame."""
        return frame_id in self.getFrameStrings()

    def getFrameStrings(self) -> list[str]:
        """All frames that have a parent."""
        return self._buffer._with_parents()

    def getLatestCommonTime(self, source_frame: str, dest_frame: str) -> Any:
        """The latest time at which it is known where they are to each other."""
        return self._buffer.get_latest_common_time(strip_leading_slash(source_frame), strip_leading_slash(dest_frame))

    def lookupTransform(self, target_frame: str, source_frame: str, time: Any) -> Place:
        """Where `source_frame` was, as seen from `target_frame`: [x, y, z] and [x, y, z, w]. At time 0, the latest."""
        target, source = strip_leading_slash(target_frame), strip_leading_slash(source_frame)
        return _place(self._buffer.lookup_transform(target, source, time))

    def lookupTransformFull(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Place:
        """The same between two times, with a frame that did not move between them."""
        target, source, fixed = map(strip_leading_slash, (target_frame, source_frame, fixed_frame))
        return _place(self._buffer.lookup_transform_full(target, target_time, source, source_time, fixed))

    def lookupTwist(self, tracking_frame: str, observation_frame: str, time: Any, averaging_interval: Any) -> Any:
        """How fast a frame moves and turns as another sees it: (x, y, z) and (x, y, z), for each second."""
        return self.lookupTwistFull(
            tracking_frame, observation_frame, observation_frame, (0, 0, 0), tracking_frame, time, averaging_interval
        )

    def lookupTwistFull(
        self,
        tracking_frame: str,
        observation_frame: str,
        reference_frame: str,
        ref_point: Any,
        reference_point_frame: str,
        time: Any,
        averaging_interval: Any,
    ) -> Any:
        """The same in the directions of a third frame, of a point of a fourth."""
        from tf import twist

        frames = tracking_frame, observation_frame, reference_frame, reference_point_frame
        return twist.lookup(self, *frames, time, averaging_interval)

    def setUsingDedicatedThread(self, value: bool) -> None:
        """Whether some other thread calls `setTransform`, so that waiting makes sense."""
        self._using_dedicated_thread = value

    def getTFPrefix(self) -> str:
        """There are no prefixes any more."""
        return ""


class TransformerROS(Transformer):
    """Brings messages into other frames."""

    def asMatrix(self, target_frame: str, hdr: Any) -> Any:
        """Where the frame of a header was, as an array of numpy, 4 by 4."""
        return self.fromTranslationRotation(*self._of(target_frame, hdr))

    def fromTranslationRotation(self, translation: Any, rotation: Any) -> Any:
        """A place as an array of numpy, 4 by 4."""
        from tf import transformations

        matrix = transformations.quaternion_matrix(rotation)
        matrix[:3, 3] = translation[:3]
        return matrix

    def _of(self, target_frame: str, header: Any) -> Place:
        return self.lookupTransform(target_frame, header.frame_id, header.stamp)

    def _new(self, kind: Any, target_frame: str, header: Any) -> Any:
        made = kind()
        made.header.stamp = header.stamp
        made.header.frame_id = target_frame
        return made

    def transformPoint(self, target_frame: str, ps: Any) -> Any:
        """The `PointStamped` as seen from another frame."""
        made = self._new(geometry_msgs.msg.PointStamped, target_frame, ps.header)
        given = ps.point.x, ps.point.y, ps.point.z
        made.point = geometry_msgs.msg.Point(*rigid.place(*self._of(target_frame, ps.header), given))
        return made

    def transformVector3(self, target_frame: str, v3s: Any) -> Any:
        """The `Vector3Stamped` as seen from another frame: it is turned, and not moved."""
        made = self._new(geometry_msgs.msg.Vector3Stamped, target_frame, v3s.header)
        _, rotation = self._of(target_frame, v3s.header)
        given = v3s.vector.x, v3s.vector.y, v3s.vector.z
        made.vector = geometry_msgs.msg.Vector3(*rigid.place((0.0, 0.0, 0.0), rotation, given))
        return made

    def transformQuaternion(self, target_frame: str, ps: Any) -> Any:
        """The `QuaternionStamped` as seen from another frame."""
        made = self._new(geometry_msgs.msg.QuaternionStamped, target_frame, ps.header)
        _, rotation = self._of(target_frame, ps.header)
        made.quaternion = geometry_msgs.msg.Quaternion(*_turned(rotation, ps.quaternion))
        return made

    def transformPose(self, target_frame: str, ps: Any) -> Any:
        """The `PoseStamped` as seen from another frame."""
        made = self._new(geometry_msgs.msg.PoseStamped, target_frame, ps.header)
        translation, rotation = self._of(target_frame, ps.header)
        at = ps.pose.position
        made.pose.position = geometry_msgs.msg.Point(*rigid.place(translation, rotation, (at.x, at.y, at.z)))
        made.pose.orientation = geometry_msgs.msg.Quaternion(*_turned(rotation, ps.pose.orientation))
        return made

    def transformPointCloud(self, target_frame: str, point_cloud: Any) -> Any:
        """The `PointCloud` as seen from another frame."""
        made = self._new(type(point_cloud), target_frame, point_cloud.header)
        made.channels = point_cloud.channels
        place = self._of(target_frame, point_cloud.header)
        kind = geometry_msgs.msg.Point32
        made.points = [kind(*rigid.place(*place, (point.x, point.y, point.z))) for point in point_cloud.points]
        return made


class TransformListener(TransformerROS):
    """Hears of frames at `/tf` and `/tf_static`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        TransformerROS.__init__(self, *args, **kwargs)
        self._listener = tf2_ros.TransformListener(self._buffer)
        self.setUsingDedicatedThread(True)


def _place(message: Any) -> Place:
    moved, turned = message.transform.translation, message.transform.rotation
    return [moved.x, moved.y, moved.z], [turned.x, turned.y, turned.z, turned.w]


def _turned(rotation: Any, own: Any) -> tuple[float, float, float, float]:
    # By way of the matrix, as ever: which of the two quaternions of a rotation comes out is seen by programs.
    q = rigid.multiply(rotation, (own.x, own.y, own.z, own.w))
    return rigid.from_rows(rigid.rows(q))
