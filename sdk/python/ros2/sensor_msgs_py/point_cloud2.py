"""Clouds of points: reads and makes messages `sensor_msgs/msg/PointCloud2`, with NumPy."""

from __future__ import annotations

import array
import sys
from collections import namedtuple

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Iterable

_DATATYPES = {
    PointField.INT8: np.dtype(np.int8), PointField.UINT8: np.dtype(np.uint8), PointField.INT16: np.dtype(np.int16),
    PointField.UINT16: np.dtype(np.uint16), PointField.INT32: np.dtype(np.int32), PointField.UINT32: np.dtype(np.uint32),
    PointField.FLOAT32: np.dtype(np.float32), PointField.FLOAT64: np.dtype(np.float64),
}  # fmt: skip

DUMMY_FIELD_PREFIX = "unnamed_field"


def dtype_from_fields(fields: Iterable[Any], point_step: int | None = None) -> Any:
    """The type of a point for NumPy; a field of several values becomes several, `NAME_0` and so on."""
    names, offsets, formats = [], [], []
    for place, field in enumerate(fields):
        name = field.name or "%s_%d" % (DUMMY_FIELD_PREFIX, place)
        if field.datatype not in _DATATYPES:
            raise ValueError("field %s of the cloud is of the unknown type %s" % (name, field.datatype))
        kind = _DATATYPES[field.datatype]
        for each in range(field.count):
            own = "%s_%d" % (name, each) if field.count > 1 else name
            if own in names:
                raise ValueError("two fields of the cloud have the name %s" % own)
            names.append(own)
            offsets.append(field.offset + each * kind.itemsize)
            formats.append(kind.str)
    told: dict[str, Any] = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        told["itemsize"] = point_step
    return np.dtype(told)


def read_points(
    cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = None, reshape_organized_cloud: bool = False
) -> Any:
    """The points as a structured array of NumPy, one row behind the other; the fields are those that are named, or all.
    `uvs` are pairs of column and row, or numbers of points."""
    points = np.ndarray(
        shape=(cloud.width * cloud.height,), dtype=dtype_from_fields(cloud.fields, cloud.point_step), buffer=bytearray(cloud.data)
    )
    if field_names is not None:
        missing = [name for name in field_names if name not in (points.dtype.names or ())]
        if missing:
            raise AssertionError("the cloud has no field %s" % ", ".join(missing))
        points = points[list(field_names)]
    if bool(sys.byteorder != "little") != bool(cloud.is_bigendian):
        points = points.byteswap(inplace=True)
    if uvs is not None:
        places = np.asarray(list(uvs) if not isinstance(uvs, np.ndarray) else uvs)
        points = points[places[:, 1] * cloud.width + places[:, 0] if places.ndim == 2 else places]
    if skip_nans:
        whole = np.ones(len(points), dtype=bool)
        for name in points.dtype.names or ():
            whole &= ~np.isnan(points[name])
        points = points[whole]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points


def read_points_numpy(
    cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = None, reshape_organized_cloud: bool = False
) -> Any:
    """The same as an array of rows, for fields that are all of one type."""
    if len({field.datatype for field in cloud.fields if field_names is None or field.name in field_names}) > 1:
        raise AssertionError("All fields need to have the same datatype. Use `read_points()` otherwise.")
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    names = points.dtype.names or ()
    return np.stack([points[name] for name in names], axis=-1)


def read_points_list(cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = None) -> list[Any]:
    """The same as a list of named tuples."""
    points = read_points(cloud, field_names, skip_nans, uvs)
    point = namedtuple("Point", points.dtype.names or ())  # type: ignore[misc]
    return [point(*values) for values in points]


def create_cloud(header: Any, fields: Any, points: Any, step: int | None = None, point_step: int | None = None) -> Any:
    """A cloud of points, given as rows of values in the order of the fields, or as an array of NumPy; an array with two
    dimensions of points becomes an organised cloud. `step` is how many bytes a point takes."""
    step = point_step if step is None else step
    kind = dtype_from_fields(fields, step)
    if isinstance(points, np.ndarray) and points.dtype.names is not None:
        if points.dtype != kind:
            raise AssertionError("PointFields and structured NumPy array dtype do not match for all fields!")
        made = points
    else:
        values = np.asarray(points)
        if values.size == 0:
            values = values.reshape(0, len(kind.names or ()))
        if values.shape[-1] != len(kind.names or ()):
            raise AssertionError("a point has %d values, and the fields %d" % (values.shape[-1], len(kind.names or ())))
        made = np.zeros(values.shape[:-1], dtype=kind)
        for place, name in enumerate(kind.names or ()):
            made[name] = values[..., place]
    height, width = made.shape if made.ndim == 2 else (1, made.shape[0])
    data: array.array[int] = array.array("B")
    data.frombytes(np.ascontiguousarray(made).tobytes())
    return PointCloud2(
        header=header, height=height, width=width, is_dense=False, is_bigendian=sys.byteorder != "little", fields=fields,
        point_step=kind.itemsize, row_step=kind.itemsize * width, data=data,
    )  # fmt: skip


def create_cloud_xyz32(header: Any, points: Any, step: int | None = None) -> Any:
    """A cloud of places, three floats each."""
    fields = [PointField(name=name, offset=place * 4, datatype=PointField.FLOAT32, count=1) for place, name in enumerate("xyz")]
    return create_cloud(header, fields, points, step)
