"""When a robot is where on its way: it speeds up, keeps its speed, and slows down, within the limits of its joints."""

from __future__ import annotations

import math

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Sequence

    Posture = Sequence[float]

#: Seconds between the points of a plan, nearly.
STEP = 0.1


class Point:
    """A point of a trajectory."""

    __slots__ = ("time", "positions", "velocities", "accelerations")

    def __init__(self, time: float, positions: Posture, velocities: Posture, accelerations: Posture) -> None:
        self.time = time
        self.positions, self.velocities, self.accelerations = tuple(positions), tuple(velocities), tuple(accelerations)


class Profile:
    """A way of some length, begun and ended at rest, with a greatest speed of 1 and this greatest acceleration."""

    def __init__(self, length: float, acceleration: float) -> None:
        self._length, self._acceleration = length, acceleration
        self._rising = 1.0 / acceleration  # how long it speeds up
        if length < self._rising:  # it never gets that fast
            self._rising = math.sqrt(length / acceleration)
        self._speed = acceleration * self._rising
        self._cruising = max(0.0, length / self._speed - self._rising) if length else 0.0
        self.duration = 2.0 * self._rising + self._cruising

    def at(self, time: float) -> tuple[float, float, float]:
        """How far it is at a time, how fast, and how quickly it gets faster."""
        if time < self._rising:
            return self._acceleration * time * time / 2.0, self._acceleration * time, self._acceleration
        if time < self._rising + self._cruising:
            return self._speed * (time - self._rising / 2.0), self._speed, 0.0
        left = max(0.0, self.duration - time)
        return self._length - self._acceleration * left * left / 2.0, self._acceleration * left, -self._acceleration

    def when(self, place: float) -> float:
        """The time at which it is so far."""
        ramp = self._speed * self._rising / 2.0
        if place <= ramp:
            return math.sqrt(2.0 * max(0.0, place) / self._acceleration)
        if place <= self._length - ramp:
            return place / self._speed + self._rising / 2.0
        return self.duration - math.sqrt(2.0 * max(0.0, self._length - place) / self._acceleration)


class _Way:
    """Postures one after the other, and how long each part takes at full speed."""

    def __init__(self, postures: Sequence[Posture], speeds: Posture, accelerations: Posture) -> None:
        self.postures = [postures[0]]
        self.ends = [0.0]
        self.changes: list[list[float]] = []  # of the joints, for each second at full speed
        limit = math.inf
        for posture in postures[1:]:
            apart = [there - here for here, there in zip(self.postures[-1], posture)]
            length = max((abs(change) / speed for change, speed in zip(apart, speeds)), default=0.0)
            if length <= 1e-12:
                continue
            change = [part / length for part in apart]
            limit = min([limit] + [most / abs(part) for part, most in zip(change, accelerations) if part])
            self.postures.append(posture)
            self.ends.append(self.ends[-1] + length)
            self.changes.append(change)
        self.profile = Profile(self.ends[-1], limit) if self.changes else None

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


def line(start: Posture, target: Posture, speeds: Posture, accelerations: Posture) -> list[Point]:
    """The straight way between two postures, a point about every tenth of a second."""
    way = _Way([start, target], speeds, accelerations)
    if way.profile is None:
        return [way.rest()]
    count = max(1, math.ceil(way.profile.duration / STEP - 1e-9))
    points = [way.point(way.profile.duration * at / count) for at in range(count + 1)]
    points[0].positions, points[-1].positions = tuple(start), tuple(target)
    return points


def lines(postures: Sequence[Posture], speeds: Posture, accelerations: Posture) -> list[Point]:
    """The straight ways from each of these postures to the next, with a rest at each."""
    points: list[Point] = []
    for start, target in zip(postures, postures[1:]):
        begun = points.pop().time if points else 0.0
        for point in line(start, target, speeds, accelerations):
            points.append(Point(begun + point.time, point.positions, point.velocities, point.accelerations))
    return points


def through(postures: Sequence[Posture], speeds: Posture, accelerations: Posture) -> list[Point]:
    """The way through these postures, with a point at each that differs from the one before."""
    way = _Way(postures, speeds, accelerations)
    if way.profile is None:
        return [way.rest()]
    points = []
    for posture, end in zip(way.postures, way.ends):
        point = way.point(way.profile.when(end))
        point.positions = tuple(posture)
        points.append(point)
    return points
