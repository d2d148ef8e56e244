"""The robot as the scenario's binding has it: groups of joints, the devices that move them, and named postures."""

from __future__ import annotations

import math

from hrdsl.binding import binding
from hrdsl.errors import ProtocolError
from hrdsl.exchange import the_exchange
from moveit_commander.exception import MoveItCommanderException
from moveit_commander.timing import Point

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
            warn_once("hrdsl plans for the place of %s, and not for its orientation" % self.tip)
        found, why = self._ask(message)
        return (None, why) if found is None else (found["value"], "")

    def way(
        self, target: dict[str, Any], begin: Sequence[float], elsewhere: bool, limits: tuple[list[float], list[float]]
    ) -> tuple[list[Point] | None, str]:
        """A way that is free, from where the joints begin, which is where they are or `elsewhere`, to a place (`to`) or to
        values (`joints`), at the times at which the arm goes it within these speeds and accelerations (rad/s and rad/s², or m/s
        and m/s²); or None and why there is none."""
        speeds, accelerations = limits
        message = {**target, "timed": True, "speeds": speeds, "accelerations": accelerations}
        if elsewhere:
            message["from"] = list(begin)
        found, why = self._ask(message)
        if found is None:
            return None, why
        count = len(self.joints)
        rows = [_rows(found.get(what, ()), count) for what in ("value", "velocities", "accelerations")]
        if not rows[0]:
            return None, "the arm has another number of joints than group %s" % self.name
        points = [Point(float(time), *at) for time, *at in zip(found["times"], *rows)]
        points[0].positions = tuple(begin)
        return points, ""

    def _ask(self, message: dict[str, Any]) -> tuple[dict[str, list[float]] | None, str]:
        try:
            answer = the_exchange().link.request({"request": "plan", "device": self.device, **message})
        except ProtocolError as error:
            return None, str(error)
        if "value" not in answer:
            return None, str(answer.get("error", "there is no such posture"))
        return {what: [float(number) for number in of] for what, of in answer.items() if isinstance(of, list)}, ""


def _rows(numbers: Sequence[float], count: int) -> list[Sequence[float]]:
    """The numbers of each point, if there are as many for all."""
    return [] if len(numbers) % count else [numbers[at : at + count] for at in range(0, len(numbers), count)]


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
