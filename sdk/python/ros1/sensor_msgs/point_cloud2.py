"""Clouds of points: reads and makes messages `sensor_msgs/PointCloud2`."""

from __future__ import annotations

import struct
from collections import namedtuple

import rospy
from hrdsl.points import letters_of, packed, rows
from sensor_msgs.msg import PointCloud2, PointField

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterable, Iterator


def read_points(cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = ()) -> Iterator[Any]:
    """The points, each a tuple of its fields in the order of their places in the bytes, row by row or at these pairs of column
    and row."""
    if getattr(cloud, "_type", None) != PointCloud2._type:
        raise AssertionError("cloud is not a sensor_msgs.msg.PointCloud2")
    known = {field.name for field in cloud.fields}
    for name in field_names or ():
        if name not in known:
            rospy.logwarn("the cloud has no field %s: it has %s" % (name, ", ".join(sorted(known))))
    yield from rows(cloud, letters_of(cloud.fields, cloud.is_bigendian, field_names), skip_nans, uvs)


def read_points_list(cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = ()) -> list[Any]:
    """The same as a list of named tuples."""
    wanted = [field.name for field in sorted(cloud.fields, key=lambda each: each.offset)]
    if field_names is not None:
        wanted = [name for name in wanted if name in field_names]
    point = namedtuple("Point", wanted)  # type: ignore[misc]
    return [point._make(values) for values in read_points(cloud, field_names, skip_nans, uvs)]


def create_cloud(header: Any, fields: Any, points: Iterable[Any]) -> Any:
    """A cloud of one row, of points with their values in the order of the fields."""
    letters = letters_of(fields, False)
    points = list(points)
    data, step = packed(letters, points, len(points)), struct.calcsize(letters)
    return PointCloud2(
        header=header, height=1, width=len(points), is_dense=False, is_bigendian=False, fields=fields, point_step=step,
        row_step=step * len(points), data=data,
    )  # fmt: skip


def create_cloud_xyz32(header: Any, points: Iterable[Any]) -> Any:
    """A cloud of places, three floats each."""
    fields = [PointField(name, place * 4, PointField.FLOAT32, 1) for place, name in enumerate("xyz")]
    return create_cloud(header, fields, points)
