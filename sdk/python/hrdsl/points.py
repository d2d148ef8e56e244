"""Points of a cloud as bytes: what `sensor_msgs.point_cloud2` of ROS 1 and `sensor_msgs_py.point_cloud2` of ROS 2 have in common."""

from __future__ import annotations

import struct

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable, Iterator

#: By the kinds of `PointField`: letters of `struct`.
LETTERS = {1: "b", 2: "B", 3: "h", 4: "H", 5: "i", 6: "I", 7: "f", 8: "d"}


def letters_of(fields: Iterable[Any], is_bigendian: bool, names: Any = None) -> str:
    """The format of a point for `struct`, in the order of the fields' places; with names, of these fields only."""
    made, place = ">" if is_bigendian else "<", 0
    for field in sorted(fields, key=lambda each: each.offset):
        if names is not None and field.name not in names:
            continue
        if field.datatype not in LETTERS:
            raise ValueError("field %s of the cloud is of the unknown type %s" % (field.name, field.datatype))
        if field.offset > place:
            made += "x" * (field.offset - place)
        letters = LETTERS[field.datatype] * max(1, field.count)
        made += letters
        place = max(place, field.offset) + struct.calcsize("<" + letters)
    return made


def rows(cloud: Any, letters: str, skip_nans: bool, uvs: Iterable[Any]) -> Iterator[tuple[Any, ...]]:
    """The values of points, row by row or at these pairs of column and row; without those that have a NaN, if asked."""
    read: Callable[..., tuple[Any, ...]] = struct.Struct(letters).unpack_from
    data, step, row = bytes(cloud.data), cloud.point_step, cloud.row_step
    places = uvs or ((u, v) for v in range(cloud.height) for u in range(cloud.width))
    for u, v in places:
        point = read(data, row * v + step * u)
        if not (skip_nans and any(value != value for value in point)):
            yield point


def packed(letters: str, points: Iterable[Any], count: int) -> bytes:
    """Points, one behind the other."""
    maker = struct.Struct(letters)
    buffer, place = bytearray(maker.size * count), 0
    for point in points:
        maker.pack_into(buffer, place, *point)
        place += maker.size
    return bytes(buffer)
