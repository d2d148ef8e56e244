"""The robot as the scenario's binding has it: groups of joints, the devices that move them, and named postures."""

from __future__ import annotations

import math

from hrdsl.binding import binding
from hrdsl.errors import ProtocolError
from hrdsl.exchange import the_exchange
from moveit_commander.exception import MoveItCommanderException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Mapping, Sequence

#: Of joints whose binding does not say: rad/s and rad/s², or m/s and m/s².
_SPEED, _ACCELERATION = 1.0, 1.0


class Joint:
    """A joint with its limits."""

    def __init__(self, given: Mapping[str, Any]) -> None:
        self.name: str = given["name"]
        lower, upper = given.get("lower"), given.get("upper")  # which a joint that turns for ever does not have
        self.lower = -math.inf if lower is None else float(lower)
        self.upper = math.inf if upper is None else float(upper)
        self.speed = float(given.get("velocity") or _SPEED)
        self.acceleration = float(given.get("acceleration") or _ACCELERATION)

    def allows(self, value: float, tolerance: float) -> bool:
        """Whether the joint can stand there."""
        return self.lower - tolerance <= value <= self.upper + tolerance

    def default(self) -> float:
        """Zero, or the middle of the range if that is outside."""
        return 0.0 if self.allows(0.0, 0.0) else (self.lower + self.upper) / 2.0


class Group:
    """A group of joints that a device moves."""

    def __init__(self, name: str, given: Mapping[str, Any]) -> None:
        self.name = name
        self.device: str = given["device"]
        self.joints = [Joint(joint) for joint in given.get("joints", ())]
        self.names = [joint.name for joint in self.joints]
        self.tip: str = given.get("tip", "tool")
        self.states: dict[str, list[float]] = {}
        for state, values in given.get("states", {}).items():
            if isinstance(values, dict):
                values = [values.get(joint.name, joint.default()) for joint in self.joints]
            self.states[state] = [float(value) for value in values]

    def positions(self) -> list[float]:
        """Where the joints are now."""
        exchange = the_exchange()
        exchange.polled("joints")
        try:
            found = [float(value) for value in exchange.state(self.device, "joints")]
        except ProtocolError as error:
            raise MoveItCommanderException(
                "the joints of group %s are not known: device %s does not tell them (%s)" % (self.name, self.device, error)
            ) from None
        if len(found) != len(self.joints):
            raise MoveItCommanderException(
                "group %s has %d joints, but its device %s has %d: correct the scenario's binding"
                % (self.name, len(self.joints), self.device, len(found))
            )
        return found

    def tool(self) -> list[float]:
        """Where the end-effector is now: [x, y, z, qx, qy, qz, qw]."""
        exchange = the_exchange()
        exchange.polled("tool")
        try:
            return [float(value) for value in exchange.state(self.device, "tool")]
        except ProtocolError as error:
            raise MoveItCommanderException(
                "the pose of the end-effector of group %s is not known: device %s does not tell it (%s)"
                % (self.name, self.device, error)
            ) from None

    def reach(self, pose: Sequence[float], begin: Sequence[float]) -> tuple[list[float] | None, str]:
        """Joint values that bring the end-effector there, near to where the joints begin, or None and why there are none."""
        message: dict[str, Any] = {"to": list(pose[:3]), "from": list(begin)}
        if len(pose) == 7:
            message["orientation"] = list(pose[3:])
        found, why = self._ask(message)
        if found is not None and len(pose) == 7:
            warn_once("hrdsl plans for the place of %s, and not for its orientation" % self.tip)
        return found, why

    def way(self, target: dict[str, Any], begin: Sequence[float]) -> tuple[list[list[float]] | None, str]:
        """The corners of a way that is free, from where the joints are to a place (`to`) or to values (`joints`); or None and why
        there is none. From where the joints are not, the way is straight."""
        found, why = self._ask({**target, "way": True})
        if found is None:
            return None, why
        count = len(self.joints)
        corners = [found[at : at + count] for at in range(0, len(found), count)]
        if len(found) % count or not corners:
            return None, "the arm has another number of joints than group %s" % self.name
        if max(abs(a - b) for a, b in zip(corners[0], begin)) > ELSEWHERE:
            corners = [list(begin), corners[-1]]
        return [list(begin), *corners[1:]] if len(corners) > 1 else [list(begin), corners[0]], ""

    def _ask(self, message: dict[str, Any]) -> tuple[list[float] | None, str]:
        try:
            answer = the_exchange().link.request({"request": "plan", "device": self.device, **message})
        except ProtocolError as error:
            return None, str(error)
        if "value" not in answer:
            return None, str(answer.get("error", "there is no such posture"))
        return [float(value) for value in answer["value"]], ""


#: How far joints may be from where they are said to begin (rad or m), so that a way from where they are is meant.
ELSEWHERE = 0.02

_warned: set[str] = set()


def warn_once(text: str) -> None:
    """Says something that is the same every time."""
    if text not in _warned:
        import rospy

        _warned.add(text)
        rospy.logwarn(text)


_groups: dict[str, Group] | None = None


def groups() -> dict[str, Group]:
    """All groups, by their names."""
    global _groups
    if _groups is None:
        _groups = {name: Group(name, given) for name, given in binding().get("groups", {}).items()}
    return _groups


def group(name: str) -> Group:
    """The group of this name."""
    found = groups().get(name)
    if found is None:
        known = ", ".join(groups()) or "none"
        raise RuntimeError("Group '%s' was not found. (The scenario's binding has: %s.)" % (name, known))
    return found


def planning_frame() -> str:
    """The frame of all poses."""
    return str(binding().get("base_frame", "world"))


def is_melodic() -> bool:
    """Whether `plan` returns what it did before Noetic."""
    return binding().get("moveit") == "melodic"
