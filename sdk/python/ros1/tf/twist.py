"""How fast a frame moves: the difference of two places by the time between them."""

from __future__ import annotations

import math

import rospy
from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Vector = tuple[float, float, float]


def lookup(
    transformer: Any, tracking: str, observation: str, reference: str, at_point_of: str, time: Any, interval: Any
) -> tuple[Vector, Vector]:
    """How fast `tracking` moves and turns as `observation` sees it, in the directions of `reference`."""
    latest = transformer.getLatestCommonTime(observation, tracking)
    wanted = time or latest
    end = min(wanted + rospy.Duration(0.5 * interval.to_sec()), latest)
    start = max(rospy.Time(0.0001) + interval, end) - interval
    seconds = (end - start).to_sec()
    begin, begin_turned = transformer.lookupTransform(observation, tracking, start)
    there, there_turned = transformer.lookupTransform(observation, tracking, end)
    moved = [(b - a) / seconds for a, b in zip(begin, there)]
    turned = [part / seconds for part in _turning(rigid.multiply(rigid.conjugate(begin_turned), there_turned))]
    place, rotation = transformer.lookupTransform(reference, tracking, wanted)
    turning = rigid.place((0.0, 0.0, 0.0), rotation, turned)
    moving = rigid.place(_cross(place, turning), rotation, moved)
    # The point's own share is a sum of products, added to each direction, as in the original.
    other, other_turned = transformer.lookupTransform(reference, at_point_of, wanted)
    shifted = rigid.place(other, other_turned, place)
    share = sum(turn * (b - a) for turn, a, b in zip(turning, place, shifted))
    return (moving[0] + share, moving[1] + share, moving[2] + share), turning


def _turning(q: Any) -> list[float]:
    """The axis of a rotation, as long as its angle."""
    x, y, z, w = q if q[3] >= 0 else tuple(-part for part in q)
    length = math.sqrt(x * x + y * y + z * z)
    factor = 2.0 * math.atan2(length, w) / length if length else 0.0
    return [x * factor, y * factor, z * factor]


def _cross(a: Any, b: Any) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
