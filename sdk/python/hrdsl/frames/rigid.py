"""Rotations and places in numbers, without any package: quaternions are (x, y, z, w), matrices lists of rows."""

from __future__ import annotations

import math

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Sequence

    Numbers = Sequence[float]
    Rows = list[list[float]]

#: Below this, a length counts as none.
EPSILON = 8.881784197001252e-16


def multiply(a: Numbers, b: Numbers) -> tuple[float, float, float, float]:
    """The rotation b, and then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Numbers) -> tuple[float, float, float, float]:
    """The rotation back, for a quaternion of length 1."""
    return -q[0], -q[1], -q[2], q[3]


def rotate(q: Numbers, v: Numbers) -> tuple[float, float, float]:
    """The vector, rotated by a quaternion of length 1."""
    x, y, z, w = multiply(multiply(q, (v[0], v[1], v[2], 0.0)), conjugate(q))
    return x, y, z


def slerp(a: Numbers, b: Numbers, part: float) -> tuple[float, ...]:
    """The rotation so far on the shorter way from a to b."""
    inner = sum(p * q for p, q in zip(a, b))
    sign = -1.0 if inner < 0 else 1.0
    angle = math.acos(min(1.0, abs(inner)))
    if not angle:
        return tuple(a)
    from_a = math.sin((1.0 - part) * angle) / math.sin(angle)
    from_b = sign * math.sin(part * angle) / math.sin(angle)
    return tuple(p * from_a + q * from_b for p, q in zip(a, b))


def rows(q: Numbers) -> Rows:
    """The matrix of a quaternion of any length, 3 by 3."""
    x, y, z, w = (float(number) for number in q[:4])
    square = x * x + y * y + z * z + w * w
    if square < EPSILON:
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    s = 2.0 / square
    return [
        [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
    ]


def from_rows(m: Any) -> tuple[float, float, float, float]:
    """The quaternion of a matrix: from the greatest of its numbers, so that nothing is divided by what is nearly 0."""
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > 0.0:
        s = 0.5 / math.sqrt(trace + 1.0)
        return (m[2][1] - m[1][2]) * s, (m[0][2] - m[2][0]) * s, (m[1][0] - m[0][1]) * s, 0.25 / s
    i = max(range(3), key=lambda place: m[place][place])
    j, k = (i + 1) % 3, (i + 2) % 3
    t = m[i][i] - m[j][j] - m[k][k] + 1.0
    s = 0.5 / math.sqrt(t)
    q = [0.0, 0.0, 0.0, (m[k][j] - m[j][k]) * s]
    q[i], q[j], q[k] = t * s, (m[i][j] + m[j][i]) * s, (m[k][i] + m[i][k]) * s
    return q[0], q[1], q[2], q[3]


# ── Euler's angles ──


def _conventions() -> dict[str, tuple[int, int, int, int]]:
    """All 24, as texts (`s`tatic or `r`otating, and the axes in their order) and as numbers: the first axis in static
    order, whether the second is not the one after it, whether the third is the first, and whether they rotate."""
    found = {}
    for first in range(3):
        for second in ((first + 1) % 3, (first + 2) % 3):
            third = 3 - first - second
            for last in (third, first):
                names = "xyz"[first] + "xyz"[second] + "xyz"[last]
                parity, repetition = int(second != (first + 1) % 3), int(last == first)
                found["s" + names] = (first, parity, repetition, 0)
                found["r" + names[::-1]] = (first, parity, repetition, 1)
    return found


CONVENTIONS = _conventions()


def convention(axes: Any) -> tuple[int, int, int, int]:
    """A convention, given in either way."""
    if isinstance(axes, str):
        axes = CONVENTIONS[axes.lower()]
    if tuple(axes) not in CONVENTIONS.values():
        raise KeyError(axes)
    first, parity, repetition, is_rotating = axes
    return first, parity, repetition, is_rotating


def quaternion(ai: float, aj: float, ak: float, axes: Any = "sxyz") -> tuple[float, float, float, float]:
    """The quaternion of three angles: the product of those about the axes."""
    first, parity, repetition, is_rotating = convention(axes)
    if is_rotating:
        ai, ak = ak, ai
    second = (first + 1 + parity) % 3
    third = first if repetition else 3 - first - second
    product = (0.0, 0.0, 0.0, 1.0)
    for angle, axis in ((ai, first), (aj, second), (ak, third)):
        about = [0.0, 0.0, 0.0, math.cos(angle / 2.0)]
        about[axis] = math.sin(angle / 2.0)
        product = multiply(about, product)
    return product


def euler(m: Any, axes: Any = "sxyz") -> tuple[float, float, float]:
    """Three angles of a matrix."""
    first, parity, repetition, is_rotating = convention(axes)
    i, j = first, (first + 1 + parity) % 3
    k = 3 - i - j
    if repetition:
        length = math.sqrt(m[i][j] * m[i][j] + m[i][k] * m[i][k])
        middle = math.atan2(length, m[i][i])
    else:
        length = math.sqrt(m[i][i] * m[i][i] + m[j][i] * m[j][i])
        middle = math.atan2(-m[k][i], length)
    if length <= EPSILON:  # only the sum or the difference of the others is known
        begin, end = math.atan2(-m[j][k], m[j][j]), 0.0
    elif repetition:
        begin, end = math.atan2(m[i][j], m[i][k]), math.atan2(m[j][i], -m[k][i])
    else:
        begin, end = math.atan2(m[k][j], m[k][k]), math.atan2(m[j][i], m[i][i])
    if parity:
        begin, middle, end = -begin, -middle, -end
    return (end, middle, begin) if is_rotating else (begin, middle, end)


# ── places and directions in another frame ──


def place(translation: Numbers, rotation: Numbers, point: Numbers) -> tuple[float, float, float]:
    """A point of a frame that lies there, as seen from outside."""
    m = rows(rotation)
    x, y, z = (sum(m[row][column] * point[column] for column in range(3)) + translation[row] for row in range(3))
    return x, y, z
