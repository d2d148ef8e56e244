"""`RobotCommander`: the robot as a whole."""

from __future__ import annotations

from hrdsl.binding import binding
from moveit_commander import conversions, model
from moveit_commander.exception import MoveItCommanderException
from moveit_commander.move_group import MoveGroupCommander

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["RobotCommander"]


def _values() -> dict[str, float]:
    """Where all joints are now, by their names."""
    found: dict[str, float] = {}
    devices = {}
    for group in model.groups().values():
        if group.device not in devices:
            devices[group.device] = group.positions()
            found.update(zip(group.names, devices[group.device]))
    return found


def current_state() -> Any:
    """Where all joints are now, as a `RobotState`."""
    import rospy
    from moveit_msgs.msg import RobotState

    made = RobotState()
    state = made.joint_state
    state.header.frame_id = model.planning_frame()
    state.header.stamp = rospy.Time.now()
    made.multi_dof_joint_state.header.frame_id = model.planning_frame()
    values = _values()
    state.name, state.position = list(values), list(values.values())
    return made


class RobotCommander:
    """Groups, joints and links by their names; each is an attribute, too."""

    class Joint:
        """A joint of the robot."""

        def __init__(self, robot: RobotCommander, name: str) -> None:
            self._robot = robot
            self._name = name

        def _joint(self) -> model.Joint:
            return _joints()[self._name][1]

        def name(self) -> str:
            """Its name."""
            return self._name

        def variable_count(self) -> int:
            """Each joint has one."""
            return 1

        def bounds(self) -> list[float]:
            """The least and the greatest value."""
            return [self.min_bound(), self.max_bound()]

        def min_bound(self) -> float:
            """The least value."""
            return self._joint().lower

        def max_bound(self) -> float:
            """The greatest value."""
            return self._joint().upper

        def value(self) -> float:
            """Where it is now."""
            return _values()[self._name]

        def move(self, position: float, wait: bool = True) -> bool:
            """Moves this joint alone."""
            group = self._robot.get_group(_joints()[self._name][0])
            group.set_joint_value_target(group.get_current_joint_values())
            group.set_joint_value_target(self._name, position)
            return group.go(wait)

    class Link:
        """A link of the robot."""

        def __init__(self, robot: RobotCommander, name: str) -> None:
            self._robot = robot
            self._name = name

        def name(self) -> str:
            """Its name."""
            return self._name

        def pose(self) -> Any:
            """Where it is now, as a `PoseStamped`; known of end-effectors only."""
            for group in model.groups().values():
                if group.tip == self._name:
                    return conversions.list_to_pose_stamped(group.tool(), model.planning_frame())
            raise MoveItCommanderException("the pose of link %s is not known: ask tf for its frame" % self._name)

    def __init__(self, robot_description: str = "robot_description", ns: str = "") -> None:
        self._groups: dict[str, MoveGroupCommander] = {}

    def get_planning_frame(self) -> str:
        """The frame of all poses."""
        return model.planning_frame()

    def get_root_link(self) -> str:
        """The link that all others hang on."""
        return model.planning_frame()

    def get_group_names(self) -> list[str]:
        """The names of all groups."""
        return list(model.groups())

    def has_group(self, name: str) -> bool:
        """Whether there is a group of this name."""
        return name in model.groups()

    def get_group(self, name: str) -> MoveGroupCommander:
        """The group of this name; always the same object."""
        if name not in self._groups:
            self._check_group(name)
            self._groups[name] = MoveGroupCommander(name)
        return self._groups[name]

    def _check_group(self, name: str) -> None:
        if not self.has_group(name):
            raise MoveItCommanderException("There is no group named %s" % name)

    def get_joint_names(self, group: str | None = None) -> list[str]:
        """The names of the joints of a group, or of all."""
        if group is None:
            return list(_joints())
        self._check_group(group)
        return list(model.groups()[group].names)

    def get_active_joint_names(self, group: str | None = None) -> list[str]:
        """The names of the joints of a group, or of all."""
        return self.get_joint_names(group)

    def get_joint(self, name: str) -> RobotCommander.Joint:
        """The joint of this name."""
        if name not in _joints():
            raise MoveItCommanderException("There is no joint named %s" % name)
        return self.Joint(self, name)

    def get_link_names(self, group: str | None = None) -> list[str]:
        """The names of the links of a group (its end-effector), or of all frames of the robot."""
        if group is not None:
            self._check_group(group)
            return [model.groups()[group].tip]
        tips = [group.tip for group in model.groups().values()]
        return list(dict.fromkeys([*binding().get("frames", ()), *tips]))

    def get_link(self, name: str) -> RobotCommander.Link:
        """The link of this name."""
        if name not in self.get_link_names():
            raise MoveItCommanderException("There is no link named %s" % name)
        return self.Link(self, name)

    def get_default_owner_group(self, joint_name: str) -> str | None:
        """The smallest group with this joint."""
        found = _joints().get(joint_name)
        return found and found[0]

    def get_current_state(self) -> Any:
        """Where all joints are now, as a `RobotState`."""
        return current_state()

    def get_current_variable_values(self) -> dict[str, float]:
        """Where all joints are now, by their names."""
        return _values()

    def get_robot_markers(self, *args: Any) -> Any:
        """Refused."""
        raise NotImplementedError("RobotCommander.get_robot_markers is not there in hrdsl: the robot has no shapes here")

    def __getattr__(self, name: str) -> Any:
        if self.has_group(name):
            return self.get_group(name)
        if name in _joints():
            return self.Joint(self, name)
        if name in self.get_link_names():
            return self.Link(self, name)
        raise AttributeError("%r object has no attribute %r" % (type(self).__name__, name))


def _joints() -> dict[str, tuple[str, model.Joint]]:
    """All joints by their names, with the smallest group of each."""
    found: dict[str, tuple[str, model.Joint]] = {}
    for group in sorted(model.groups().values(), key=lambda group: len(group.joints)):
        for joint in group.joints:
            found.setdefault(joint.name, (group.name, joint))
    return found
