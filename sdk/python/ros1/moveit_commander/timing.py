"""When a robot is where on a way that it is given: it speeds up, keeps its speed, and slows down, as in the world's own motions."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Sequence

    Posture = Sequence[float]


class Point:
    """A point of a trajectory."""

    __slots__ = ("time", "positions", "velocities", "accelerations")

    def __init__(self, time: float, positions: Posture, velocities: Posture, accelerations: Posture) -> None:
        self.time = time
        self.positions, self.velocities, self.accelerations = tuple(positions), tuple(velocities), tuple(accelerations)


class Profile:
    """A way of some length, begun and ended at rest, with a greatest speed of 1, to which it comes by a smooth step in `rise`
    seconds."""

    def __init__(self, length: float, rise: float) -> None:
        self._length, self._rise = length, rise
        self._speed = min(1.0, length / rise)  # a short way takes no less than both ramps
        self._ramp = self._speed * rise / 2.0
        self.duration = (length - 2.0 * self._ramp) / self._speed + 2.0 * rise

    def at(self, time: float) -> tuple[float, float, float]:
        """How far it is at a time, how fast, and how quickly it gets faster."""
        left = max(0.0, self.duration - time)
        if time < self._rise:
            return self._risen(time)
        if left < self._rise:
            ahead, speed, rise = self._risen(left)
            return self._length - ahead, speed, -rise
        return self._ramp + self._speed * (time - self._rise), self._speed, 0.0

    def _risen(self, time: float) -> tuple[float, float, float]:
        u = time / self._rise
        return (
            self._speed * self._rise * u * u * u * (1.0 - u / 2.0),
            self._speed * u * u * (3.0 - 2.0 * u),
            self._speed * 6.0 * u * (1.0 - u) / self._rise,
        )

    def when(self, place: float) -> float:
        """The time at which it is so far."""
        if place > self._length / 2.0:
            return self.duration - self.when(self._length - place)
        if place > self._ramp:
            return self._rise + (place - self._ramp) / self._speed
        low, high = 0.0, self._rise
        while low < (middle := (low + high) / 2.0) < high:
            low, high = (middle, high) if self._risen(middle)[0] < place else (low, middle)
        return high if place > 0.0 else 0.0


class _Way:
    """Postures one after the other, and how long each part takes at full speed."""

    def __init__(self, postures: Sequence[Posture], speeds: Posture, accelerations: Posture) -> None:
        self.postures = [postures[0]]
        self.ends = [0.0]
        self.changes: list[list[float]] = []  # of the joints, for each second at full speed
        rise = 0.0
        for posture in postures[1:]:
            apart = [there - here for here, there in zip(self.postures[-1], posture)]
            length = max((abs(change) / speed for change, speed in zip(apart, speeds)), default=0.0)
            if length <= 1e-12:
                continue
            change = [part / length for part in apart]
            rise = max([rise] + [abs(part) / most for part, most in zip(change, accelerations)])
            self.postures.append(posture)
            self.ends.append(self.ends[-1] + length)
            self.changes.append(change)
        self.profile = Profile(self.ends[-1], rise) if self.changes else None

    def point(self, time: float) -> Point:
        """Where it is at a time."""
        assert self.profile is not None
        place, speed, rise = self.profile.at(time)
        at = 0
        while at + 1 < len(self.changes) and place > self.ends[at + 1]:
            at += 1
        change, begin = self.changes[at], self.postures[at]
        ahead = place - self.ends[at]
        return Point(
            time,
            [start + part * ahead for start, part in zip(begin, change)],
            [part * speed for part in change],
            [part * rise for part in change],
        )

    def rest(self) -> Point:
        """The one point of a way that leads nowhere."""
        zeros = [0.0] * len(self.postures[0])
        return Point(0.0, self.postures[0], zeros, zeros)


def through(postures: Sequence[Posture], speeds: Posture, accelerations: Posture) -> list[Point]:
    """The way through these postures without a rest, with a point at each that differs from the one before."""
    way = _Way(postures, speeds, accelerations)
    if way.profile is None:
        return [way.rest()]
    points = []
    for posture, end in zip(way.postures, way.ends):
        point = way.point(way.profile.when(end))
        point.positions = tuple(posture)
        points.append(point)
    return points
