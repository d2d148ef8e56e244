"""Messages as bytes, as ROS 1 sends them; for programs that write and read them themselves."""

from __future__ import annotations

import _struct

from genpy.message import DeserializationError
from genpy.rostime import Duration, Time
from genpy.values import CODES, failed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def write(message: Any, file: Any) -> None:
    """Writes all fields."""
    try:
        parts: list[bytes] = []
        _write(message, parts)
    except (_struct.error, TypeError, ValueError) as error:
        failed(message, error)
    file.write(b"".join(parts))


def _write(message: Any, parts: list[bytes]) -> None:
    for field in message._definition["fields"]:
        value, kind, array = getattr(message, field["name"]), field["type"], field.get("array")
        if array is None:
            _write_one(value, kind, parts)
            continue
        count = array["exactly"] if isinstance(array, dict) else None
        if count is None:
            parts.append(_struct.pack("<I", len(value)))
        elif len(value) != count:
            raise ValueError("Expecting %s items but found %s" % (count, len(value)))
        if isinstance(value, bytes):
            parts.append(value)
        elif kind in CODES:
            parts.append(_struct.pack("<%d%s" % (len(value), CODES[kind]), *value))
        else:
            for element in value:
                _write_one(element, kind, parts)


def _write_one(value: Any, kind: str, parts: list[bytes]) -> None:
    if kind in CODES:
        parts.append(_struct.pack("<" + CODES[kind], value))
    elif kind == "string":
        data = value.encode("utf-8") if isinstance(value, str) else value
        parts.append(_struct.pack("<I", len(data)) + data)
    elif kind in ("time", "duration"):
        parts.append(_struct.pack("<II" if kind == "time" else "<ii", value.secs, value.nsecs))
    else:
        _write(value, parts)


def read(message: Any, data: bytes) -> Any:
    """Fills the message from bytes, and returns it."""
    try:
        _read(message, bytes(data), 0)
    except (_struct.error, IndexError) as error:
        raise DeserializationError(error) from None
    return message


def _read(message: Any, data: bytes, at: int) -> int:
    for field in message._definition["fields"]:
        kind, array = field["type"], field.get("array")
        if array is None:
            value, at = _read_one(message, field, data, at)
        else:
            count = array["exactly"] if isinstance(array, dict) else None
            if count is None:
                (count,) = _struct.unpack_from("<I", data, at)
                at += 4
            if kind in CODES:
                form = "<%d%s" % (count, CODES[kind])
                found = _struct.unpack_from(form, data, at)
                at += _struct.calcsize(form)
                value = bytes(found) if kind in ("uint8", "char") else [bool(v) for v in found] if kind == "bool" else found
            else:
                value = []
                for _ in range(count):
                    one, at = _read_one(message, field, data, at)
                    value.append(one)
        setattr(message, field["name"], value)
    return at


def _read_one(message: Any, field: dict[str, Any], data: bytes, at: int) -> tuple[Any, int]:
    kind = field["type"]
    if kind in CODES:
        form = "<" + CODES[kind]
        (value,) = _struct.unpack_from(form, data, at)
        return bool(value) if kind == "bool" else value, at + _struct.calcsize(form)
    if kind == "string":
        (length,) = _struct.unpack_from("<I", data, at)
        if at + 4 + length > len(data):
            raise IndexError("the string is cut off")
        return data[at + 4 : at + 4 + length].decode("utf-8", "replace"), at + 4 + length
    if kind in ("time", "duration"):
        secs, nsecs = _struct.unpack_from("<II" if kind == "time" else "<ii", data, at)
        return (Time if kind == "time" else Duration)(secs, nsecs), at + 8
    from hrdsl.interfaces import class_of

    inner = class_of(kind)()
    return inner, _read(inner, data, at)


def with_numpy(message: Any, numpy: Any) -> Any:
    """Makes arrays of numbers arrays of NumPy."""
    for field in message._definition["fields"]:
        kind, name = field["type"], field["name"]
        if "array" in field and kind in CODES:
            value = getattr(message, name)
            dtype = numpy.dtype("bool" if kind == "bool" else "<" + CODES[kind])
            made = numpy.frombuffer(value, dtype) if isinstance(value, bytes) else numpy.array(value, dtype)
            setattr(message, name, made)
    return message
