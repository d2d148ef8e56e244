"""What a group is to reach, and how: the part of `MoveGroupCommander` that only keeps what it is told."""

from __future__ import annotations

from moveit_commander import conversions, model
from moveit_commander.exception import MoveItCommanderException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn, Sequence

_OUT_OF_BOUNDS = "Error setting joint target. Is the target within bounds?"
_EXACT = "plans are exact: tolerances of positions and orientations are kept, and change no plan"
_ONE_PLANNER = "there is one planner, hrdsl's own: identifiers of planners and pipelines are kept, and change no plan"


def unsupported(what: str, instead: str) -> NoReturn:
    """Refuses what there is not."""
    raise NotImplementedError("MoveGroupCommander.%s is not there in hrdsl: %s" % (what, instead))


class Targets:
    """Targets, tolerances and settings of a group."""

    def __init__(self, name: str) -> None:
        self._group = model.group(name)
        self._joint_target = [joint.default() for joint in self._group.joints]
        self._pose_target: list[float] | None = None
        self._remembered: dict[str, list[float]] = {}
        self._start: Any = None
        self._tip = self._group.tip
        self._reference_frame = model.planning_frame()
        self._tolerances = {"joint": 1e-4, "position": 1e-4, "orientation": 1e-3}
        self._planning_time = 5.0
        self._planner, self._pipeline = "", ""
        self._speed_factor = self._acceleration_factor = 1.0

    # ── names and frames ──

    def get_name(self) -> str:
        """The group's name."""
        return self._group.name

    def get_active_joints(self) -> list[str]:
        """The names of its joints."""
        return list(self._group.names)

    def get_joints(self) -> list[str]:
        """The names of its joints."""
        return list(self._group.names)

    def get_variable_count(self) -> int:
        """How many numbers a posture has."""
        return len(self._group.joints)

    def has_end_effector_link(self) -> bool:
        """Whether it has an end-effector."""
        return bool(self._tip)

    def get_end_effector_link(self) -> str:
        """The name of its end-effector."""
        return self._tip

    def set_end_effector_link(self, link_name: str) -> None:
        """The device has one end-effector, which no other can stand for."""
        if link_name != self._tip:
            raise MoveItCommanderException("Unable to set end effector link")

    def get_planning_frame(self) -> str:
        """The frame of all poses."""
        return model.planning_frame()

    def get_pose_reference_frame(self) -> str:
        """The frame in which poses are given."""
        return self._reference_frame

    def set_pose_reference_frame(self, reference_frame: str) -> None:
        """Poses are in the planning frame, and in no other."""
        self._check_frame(reference_frame)
        self._reference_frame = reference_frame

    def _check_frame(self, frame: str) -> None:
        if frame.lstrip("/") not in ("", model.planning_frame().lstrip("/")):
            raise MoveItCommanderException(
                "group %s plans in the frame %s, not in %s: bring the pose there first, by tf"
                % (self._group.name, model.planning_frame(), frame)
            )

    # ── joint targets ──

    def get_joint_value_target(self) -> list[float]:
        """The posture to reach."""
        return list(self._joint_target)

    def set_joint_value_target(self, arg1: Any, arg2: Any = None, arg3: Any = None) -> None:
        """A posture: a list, a dictionary by the joints' names, a `JointState`, or the name and value of one joint; or a pose,
        of which the posture is asked for at once."""
        if conversions.is_message(arg1, "geometry_msgs/Pose") or conversions.is_message(arg1, "geometry_msgs/PoseStamped"):
            self._set_joints_for(arg1)
            return
        if isinstance(arg1, str):
            if arg2 is None:
                raise MoveItCommanderException("Joint value expected when joint name specified")
            if arg3 is not None:
                raise MoveItCommanderException("Too many arguments specified")
            self._set_some({arg1: arg2[0] if hasattr(arg2, "__getitem__") else arg2})
            return
        if arg2 is not None or arg3 is not None:
            raise MoveItCommanderException("Too many arguments specified")
        if conversions.is_message(arg1, "sensor_msgs/JointState"):
            self._set_some(dict(zip(arg1.name, arg1.position)), others_count=False)
        elif isinstance(arg1, dict):
            self._set_some(arg1)
        elif hasattr(arg1, "__iter__"):
            self._set_all(list(arg1))
        else:
            raise MoveItCommanderException("Unsupported argument of type %s" % type(arg1))

    def _set_all(self, values: Sequence[float]) -> None:
        if len(values) != len(self._group.joints):
            self._say_wrong("it has %d joints, and %d values are given" % (len(self._group.joints), len(values)))
        self._set_some(dict(zip(self._group.names, values)))

    def _set_some(self, values: dict[str, Any], others_count: bool = True) -> None:
        target = list(self._joint_target)
        for name, value in values.items():
            if name in self._group.names:
                target[self._group.names.index(name)] = float(value)
            elif others_count:
                self._say_wrong("it has no joint %s (but %s)" % (name, ", ".join(self._group.names)))
        for joint, value in zip(self._group.joints, target):
            if not joint.allows(value, self._tolerances["joint"]):
                self._say_wrong("%s cannot be %g, but %g to %g" % (joint.name, value, joint.lower, joint.upper))
        self._joint_target, self._pose_target = target, None

    def _say_wrong(self, why: str) -> NoReturn:
        import rospy

        rospy.logerr("target of group %s: %s" % (self._group.name, why))
        raise MoveItCommanderException(_OUT_OF_BOUNDS)

    def _set_joints_for(self, pose: Any) -> None:
        found, why = self._group.reach(self._pose(pose), self._group.positions())
        if found is None:
            raise MoveItCommanderException("Error setting joint target. Is the IK solver functional? (%s)" % why)
        self._set_all(found)

    def get_random_joint_values(self) -> list[float]:
        """A posture somewhere within the bounds."""
        import random

        return [random.uniform(max(joint.lower, -3.2), min(joint.upper, 3.2)) for joint in self._group.joints]

    def set_random_target(self) -> None:
        """A posture somewhere within the bounds is to be reached."""
        self._set_all(self.get_random_joint_values())

    # ── named targets ──

    def get_named_targets(self) -> list[str]:
        """The names of postures."""
        return list(dict.fromkeys([*self._group.states, *self._remembered]))

    def set_named_target(self, name: str) -> None:
        """A posture with a name is to be reached."""
        values = self._remembered.get(name, self._group.states.get(name))
        if values is None:
            known = ", ".join(self.get_named_targets()) or "none"
            raise MoveItCommanderException(
                "Unable to set target %s. Is the target within bounds? (Known targets: %s.)" % (name, known)
            )
        self._set_all(values)

    def get_named_target_values(self, target: str) -> dict[str, float]:
        """The values of a named posture, by the joints' names."""
        values = self._remembered.get(target, self._group.states.get(target))
        return {} if values is None else dict(zip(self._group.names, values))

    def remember_joint_values(self, name: str, values: Sequence[float] | None = None) -> None:
        """Gives a posture a name; by default, the present one."""
        self._remembered[name] = self._group.positions() if values is None else list(values)

    def get_remembered_joint_values(self) -> dict[str, list[float]]:
        """Those postures."""
        return self._remembered

    def forget_joint_values(self, name: str) -> None:
        """Forgets one."""
        self._remembered.pop(name, None)

    # ── pose targets ──

    def _pose(self, pose: Any) -> list[float]:
        if conversions.is_message(pose, "geometry_msgs/PoseStamped"):
            self._check_frame(pose.header.frame_id)
            pose = pose.pose
        if conversions.is_message(pose, "geometry_msgs/Pose"):
            return conversions.pose_to_list(pose)
        return conversions.numbers(pose)

    def _check_tip(self, link: str) -> None:
        if link and link != self._tip:
            raise MoveItCommanderException("group %s has no end-effector %s, but %s" % (self._group.name, link, self._tip))

    def set_pose_target(self, pose: Any, end_effector_link: str = "") -> None:
        """Where the end-effector is to go: a `Pose`, a `PoseStamped`, or a list of 6 or 7 numbers."""
        self._check_tip(end_effector_link)
        self._pose_target = self._pose(pose)

    def set_pose_targets(self, poses: Sequence[Any], end_effector_link: str = "") -> None:
        """Several of which one is to be reached: here, the first."""
        if not poses:
            raise MoveItCommanderException("Unable to set target poses")
        self.set_pose_target(poses[0], end_effector_link)

    def set_position_target(self, xyz: Sequence[float], end_effector_link: str = "") -> None:
        """Where the end-effector is to go, turned as it likes."""
        self._check_tip(end_effector_link)
        self._pose_target = [float(xyz[axis]) for axis in range(3)]

    def set_orientation_target(self, q: Sequence[float], end_effector_link: str = "") -> None:
        """Refused."""
        unsupported("set_orientation_target", "set the angles of the joints (set_joint_value_target)")

    def set_rpy_target(self, rpy: Sequence[float], end_effector_link: str = "") -> None:
        """Refused."""
        unsupported("set_rpy_target", "set the angles of the joints (set_joint_value_target)")

    def clear_pose_target(self, end_effector_link: str = "") -> None:
        """Forgets the pose to reach."""
        self._pose_target = None

    def clear_pose_targets(self) -> None:
        """Forgets the pose to reach."""
        self._pose_target = None

    # ── tolerances and settings ──

    def get_goal_tolerance(self) -> tuple[float, ...]:
        """Those of joints, positions and orientations."""
        return tuple(self._tolerances.values())

    def get_goal_joint_tolerance(self) -> float:
        """How far a joint may be off."""
        return self._tolerances["joint"]

    def get_goal_position_tolerance(self) -> float:
        """How far the end-effector may be off."""
        return self._tolerances["position"]

    def get_goal_orientation_tolerance(self) -> float:
        """By which angle it may be turned."""
        return self._tolerances["orientation"]

    def set_goal_tolerance(self, value: float) -> None:
        """Sets all three."""
        model.warn_once(_EXACT)
        self._tolerances = {kind: float(value) for kind in self._tolerances}

    def set_goal_joint_tolerance(self, value: float) -> None:
        """Is kept, and used for the bounds of joints."""
        self._tolerances["joint"] = float(value)

    def set_goal_position_tolerance(self, value: float) -> None:
        """Is kept; plans are exact."""
        model.warn_once(_EXACT)
        self._tolerances["position"] = float(value)

    def set_goal_orientation_tolerance(self, value: float) -> None:
        """Is kept; plans are exact."""
        model.warn_once(_EXACT)
        self._tolerances["orientation"] = float(value)

    def set_max_velocity_scaling_factor(self, value: float) -> None:
        """Which part of the joints' speeds plans use."""
        self._speed_factor = self._factor(value)

    def set_max_acceleration_scaling_factor(self, value: float) -> None:
        """Which part of their accelerations."""
        self._acceleration_factor = self._factor(value)

    def _factor(self, value: float) -> float:
        if value > 0 and value <= 1:
            return float(value)
        raise MoveItCommanderException("Expected value in the range from 0 to 1 for scaling factor")

    def set_planning_time(self, seconds: float) -> None:
        """Is kept; plans take no time."""
        self._planning_time = float(seconds)

    def get_planning_time(self) -> float:
        """As it was set."""
        return self._planning_time

    def set_planner_id(self, planner_id: str) -> None:
        """Is kept; there is one planner."""
        model.warn_once(_ONE_PLANNER)
        self._planner = str(planner_id)

    def get_planner_id(self) -> str:
        """As it was set."""
        return self._planner

    def set_planning_pipeline_id(self, planning_pipeline: str) -> None:
        """Is kept; there is one planner."""
        model.warn_once(_ONE_PLANNER)
        self._pipeline = str(planning_pipeline)

    def get_planning_pipeline_id(self) -> str:
        """As it was set."""
        return self._pipeline

    def set_num_planning_attempts(self, num_planning_attempts: int) -> None:
        """Has no effect: each attempt would give the same plan."""

    def set_workspace(self, ws: Sequence[float]) -> None:
        """Has no effect, but is checked."""
        if len(ws) not in (0, 4, 6):
            raise MoveItCommanderException("Expected 0, 4 or 6 values in list specifying workspace")

    def allow_looking(self, value: bool) -> None:
        """Has no effect."""

    def allow_replanning(self, value: bool) -> None:
        """Has no effect."""

    def set_support_surface_name(self, value: str) -> None:
        """Has no effect."""

    def get_known_constraints(self) -> list[str]:
        """There are none."""
        return []

    def clear_path_constraints(self) -> None:
        """There are none."""

    def clear_trajectory_constraints(self) -> None:
        """There are none."""

    def clear_max_cartesian_link_speed(self) -> None:
        """There is none."""
