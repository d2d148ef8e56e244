"""`MoveGroupCommander`: plans and moves a group of joints."""

from __future__ import annotations

import math

import rospy
from moveit_commander import conversions, model, motion, timing
from moveit_commander.exception import MoveItCommanderException
from moveit_commander.targets import Targets, unsupported

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Sequence

__all__ = ["MoveGroupCommander"]

#: As far as a joint may stand from where a trajectory begins.
_START_TOLERANCE = 0.01

_SUCCESS, _NO_POSTURE = 1, -31


class MoveGroupCommander(Targets):
    """A group of joints, as the scenario's binding has it."""

    def __init__(
        self, name: str, robot_description: str = "robot_description", ns: str = "", wait_for_servers: float = 5.0
    ) -> None:
        Targets.__init__(self, name)

    # ── how it is ──

    def get_current_joint_values(self) -> list[float]:
        """Where the joints are now."""
        return self._group.positions()

    def get_current_pose(self, end_effector_link: str = "") -> Any:
        """Where the end-effector is now, as a `PoseStamped`."""
        self._check_tip(end_effector_link)
        return conversions.list_to_pose_stamped(self._group.tool(), self.get_planning_frame())

    def get_current_rpy(self, end_effector_link: str = "") -> list[float]:
        """How the end-effector is turned now: [roll, pitch, yaw]."""
        from hrdsl.frames import rigid

        self._check_tip(end_effector_link)
        return list(rigid.euler(rigid.rows(self._group.tool()[3:])))

    def get_current_state(self) -> Any:
        """The posture of all groups, as a `RobotState`."""
        from moveit_commander.robot import current_state

        return current_state()

    def get_current_state_bounded(self) -> Any:
        """The same, with each joint within its bounds."""
        return self.enforce_bounds(self.get_current_state())

    def enforce_bounds(self, robot_state_msg: Any) -> Any:
        """The `RobotState`, with each joint of the group within its bounds."""
        bounds = {joint.name: joint for joint in self._group.joints}
        state = robot_state_msg.joint_state
        state.position = [
            min(max(value, bounds[name].lower), bounds[name].upper) if name in bounds else value
            for name, value in zip(state.name, state.position)
        ]
        return robot_state_msg

    def get_random_pose(self, end_effector_link: str = "") -> Any:
        """Refused."""
        unsupported("get_random_pose", "choose a place (set_position_target), or random joint values")

    # ── planning ──

    def set_start_state_to_current_state(self) -> None:
        """Plans begin where the joints are."""
        self._start = None

    def set_start_state(self, msg: Any) -> None:
        """Plans begin where this `RobotState` has the joints."""
        self._start = dict(zip(msg.joint_state.name, msg.joint_state.position))

    def _begin(self) -> tuple[list[float], bool]:
        """Where plans begin, and whether the joints are elsewhere."""
        now = self._group.positions()
        if self._start is None:
            return now, False
        begin = [float(self._start.get(name, value)) for name, value in zip(self._group.names, now)]
        return begin, max(abs(a - b) for a, b in zip(begin, now)) > model.ELSEWHERE

    def plan(self, joints: Any = None) -> Any:
        """The way to the target, or to what is given: (success, `RobotTrajectory`, planning time, `MoveItErrorCodes`); in
        Melodic, the trajectory, which has no points if there is no way."""
        self._take(joints)
        code, trajectory = self._plan()
        if model.is_melodic():
            return trajectory
        from moveit_msgs.msg import MoveItErrorCodes

        return code == _SUCCESS, trajectory, 0.0, MoveItErrorCodes(val=code)

    def _take(self, joints: Any) -> None:
        if joints is None:
            return
        if isinstance(joints, str):
            if joints not in self._remembered:
                raise MoveItCommanderException("no joint values are remembered as %s" % joints)
            self._set_all(self._remembered[joints])
        elif conversions.is_message(joints, "geometry_msgs/Pose"):
            self.set_pose_target(joints)
        else:
            self.set_joint_value_target(joints)

    def _plan(self) -> tuple[int, Any]:
        begin, elsewhere = self._begin()
        target: dict[str, Any] = {"joints": self._joint_target}
        if self._pose_target is not None:
            target = {"to": list(self._pose_target[:3])}
            if len(self._pose_target) == 7:
                target["orientation"] = list(self._pose_target[3:])
                model.warn_once("hrdsl plans for the place of %s, and not for its orientation" % self._group.tip)
        points, why = self._group.way(target, begin, elsewhere, self._limits())
        if points is None:
            rospy.logwarn("group %s cannot reach its target: %s" % (self._group.name, why))
            return _NO_POSTURE, self._trajectory([])
        return _SUCCESS, self._trajectory(points)

    def _limits(self, speed: float | None = None, acceleration: float | None = None) -> tuple[list[float], list[float]]:
        speed = self._speed_factor if speed is None else speed
        acceleration = self._acceleration_factor if acceleration is None else acceleration
        joints = self._group.joints
        return [joint.speed * speed for joint in joints], [joint.acceleration * acceleration for joint in joints]

    def _trajectory(self, points: Sequence[timing.Point]) -> Any:
        from moveit_msgs.msg import RobotTrajectory
        from trajectory_msgs.msg import JointTrajectoryPoint

        made = RobotTrajectory()
        inner = made.joint_trajectory
        if points:
            inner.header.frame_id = self.get_planning_frame()
            inner.joint_names = list(self._group.names)
        for point in points:
            one = JointTrajectoryPoint()
            one.positions, one.velocities, one.accelerations = point.positions, point.velocities, point.accelerations
            one.time_from_start = rospy.Duration(0, round(point.time * 1e9))
            inner.points.append(one)
        return made

    def compute_cartesian_path(
        self,
        waypoints: Sequence[Any],
        eef_step: float,
        jump_threshold: Any = True,
        avoid_collisions: bool = True,
        path_constraints: Any = None,
    ) -> tuple[Any, float]:
        """The way of the end-effector along straight lines through these poses, and which part of it there is."""
        if path_constraints:
            unsupported("compute_cartesian_path with path_constraints", "leave them out")
        places = self._straight([self._pose(pose) for pose in waypoints], float(eef_step))
        postures = [self._begin()[0]]
        for place in places:
            found, _ = self._group.reach(place, postures[-1])
            if found is None:
                break
            postures.append(found)
        points = timing.through(postures, *self._limits())
        return self._trajectory(points), (len(postures) - 1) / len(places) if places else 1.0

    def _straight(self, poses: Sequence[list[float]], step: float) -> list[list[float]]:
        """Places at most a step apart, on lines from where the end-effector is."""
        if step <= 0:
            raise MoveItCommanderException("eef_step must be greater than 0, and is %g" % step)
        here, places = self._group.tool()[:3], []
        for pose in poses:
            there = pose[:3]
            count = max(1, math.ceil(math.dist(here, there) / step - 1e-9))
            for at in range(1, count + 1):
                places.append([a + (b - a) * at / count for a, b in zip(here, there)])
            here = there
        return places

    def retime_trajectory(
        self,
        ref_state_in: Any,
        traj_in: Any,
        velocity_scaling_factor: float = 1.0,
        acceleration_scaling_factor: float = 1.0,
        algorithm: str = "iterative_time_parameterization",
    ) -> Any:
        """The trajectory through the same postures, at other times."""
        reference = dict(zip(ref_state_in.joint_state.name, ref_state_in.joint_state.position))
        postures = self._postures(traj_in.joint_trajectory, [reference.get(name, 0.0) for name in self._group.names])
        if not postures:
            return self._trajectory([])
        limits = self._limits(self._factor(velocity_scaling_factor), self._factor(acceleration_scaling_factor))
        return self._trajectory(timing.through(postures, *limits))

    def _postures(self, trajectory: Any, otherwise: Sequence[float]) -> list[list[float]]:
        """The points of a trajectory as postures of the group."""
        places = {name: place for place, name in enumerate(trajectory.joint_names)}
        strange = [name for name in places if name not in self._group.names]
        if strange:
            raise MoveItCommanderException("group %s has no joints %s" % (self._group.name, ", ".join(strange)))
        return [
            [
                float(point.positions[places[name]]) if name in places else float(value)
                for name, value in zip(self._group.names, otherwise)
            ]
            for point in trajectory.points
        ]

    # ── motion ──

    def go(self, joints: Any = None, wait: bool = True) -> bool:
        """Plans and moves to the target, or to what is given: whether it was reached; without `wait`, whether it was begun."""
        if isinstance(joints, bool):
            wait, joints = joints, None
        self._take(joints)
        code, trajectory = self._plan()
        return code == _SUCCESS and self._follow(trajectory.joint_trajectory, wait)

    def execute(self, trajectory: Any, wait: bool = True) -> bool:
        """Moves along a trajectory: whether its end was reached; without `wait`, whether it was begun."""
        inner = getattr(trajectory, "joint_trajectory", trajectory)
        if not hasattr(inner, "points"):
            raise MoveItCommanderException(
                "execute takes a trajectory, and not a %s: plan() returns (success, trajectory, planning time, error code)"
                % type(inner).__name__
            )
        return self._follow(inner, wait)

    def _follow(self, trajectory: Any, wait: bool) -> bool:
        if not trajectory.points:
            rospy.logwarn("group %s: a trajectory without points is not executed" % self._group.name)
            return False
        now = self._group.positions()
        postures = self._postures(trajectory, now)
        for joint, begin, value in zip(self._group.joints, postures[0], now):
            if abs(begin - value) > _START_TOLERANCE:
                rospy.logerr(
                    "\nInvalid Trajectory: start point deviates from current robot state more than %g\n"
                    "joint '%s': expected: %g, current: %g" % (_START_TOLERANCE, joint.name, begin, value)
                )
                return False
        times = [point.time_from_start.to_nsec() / 1e9 for point in trajectory.points]
        ended = motion.follow(self._group, postures, times)
        if not wait:
            return True
        (why,) = ended.get()
        if why is not None:
            rospy.loginfo("ABORTED: %s", why)
        return why is None

    def stop(self) -> None:
        """Ends the motion of the group, and stays."""
        motion.stop(self._group)

    # ── what there is not ──

    def shift_pose_target(self, axis: int, value: float, end_effector_link: str = "") -> None:
        """Moves the pose to reach along an axis (0, 1, 2), or turns it about one (3, 4, 5)."""
        from hrdsl.frames import rigid

        self._check_tip(end_effector_link)
        if not 0 <= axis < 6:
            raise MoveItCommanderException("An axis value between 0 and 5 expected")
        pose = self._group.tool()
        shifted = pose[:3] + list(rigid.euler(rigid.rows(pose[3:])))
        shifted[axis] += value
        self.set_pose_target(shifted if axis > 2 else shifted[:3] + pose[3:])

    def attach_object(self, object_name: str, link_name: str = "", touch_links: Sequence[str] = []) -> bool:
        """Keeps that the object is attached."""
        from moveit_commander.planning_scene_interface import PlanningSceneInterface

        PlanningSceneInterface().attach_object(object_name, link_name or self._tip, list(touch_links))
        return True

    def detach_object(self, name: str = "") -> bool:
        """Keeps that the object, or all of a link, are detached."""
        from moveit_commander.planning_scene_interface import detach

        return detach(name)

    def pick(self, object_name: str, grasp: Any = [], plan_only: bool = False) -> bool:
        """Refused."""
        unsupported("pick", "move the group there, close the gripper and attach the object")

    def place(self, object_name: str, location: Any = None, plan_only: bool = False) -> bool:
        """Refused."""
        unsupported("place", "move the group there, open the gripper and detach the object")

    def set_path_constraints(self, value: Any) -> None:
        """Only None is taken."""
        if value is not None:
            unsupported("set_path_constraints", "plan in steps (compute_cartesian_path)")

    def set_trajectory_constraints(self, value: Any) -> None:
        """Only None is taken."""
        if value is not None:
            unsupported("set_trajectory_constraints", "plan in steps (compute_cartesian_path)")

    def __getattr__(self, name: str) -> Any:
        if name in _MISSING:
            unsupported(name, "a plan is the way that hrdsl's own planner finds")
        raise AttributeError("%r object has no attribute %r" % (type(self).__name__, name))


_MISSING = (
    "get_jacobian_matrix get_interface_description get_path_constraints get_trajectory_constraints"
    " set_constraints_database construct_motion_plan_request limit_max_cartesian_link_speed"
).split()
