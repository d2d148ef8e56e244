"""Messages as bytes, as ROS 1 sends them; for programs that write and read them themselves."""

from __future__ import annotations

import _struct

from genpy.message import DeserializationError
from genpy.rostime import Duration, Time
from genpy.values import BYTES, CODES, Unpackable, failed, packed_bytes

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Setter = tuple[Any, str, Any]

_TIMES = {"time": ("II", Time), "duration": ("ii", Duration)}


def write(message: Any, file: Any, is_numpy: bool = False) -> None:
    """Writes all fields; arrays of numbers as they are in memory if they are NumPy's."""
    try:
        parts: list[bytes] = []
        _write(message, message._definition, parts, is_numpy)
    except (Unpackable, TypeError, ValueError) as error:
        failed(message, error)
    file.write(b"".join(parts))


def _write(message: Any, definition: dict[str, Any], parts: list[bytes], is_numpy: bool) -> None:
    for field in definition["fields"]:
        value, kind, array = getattr(message, field["name"]), field["type"], field.get("array")
        if array is None:
            _write_one(value, kind, parts, is_numpy)
            continue
        count = array["exactly"] if isinstance(array, dict) else None
        if count is None:
            parts.append(_struct.pack("<I", len(value)))
        if kind in BYTES:
            if type(value) in (list, tuple):
                parts.append(_struct.pack("<%dB" % (len(value) if count is None else count), *value))
            else:
                parts.append(packed_bytes(value, count))
        elif kind in CODES:
            if is_numpy:
                parts.append(_memory(value))
            else:
                parts.append(_struct.pack("<%d%s" % (len(value) if count is None else count, CODES[kind]), *value))
        elif count is not None and len(value) != count:
            raise ValueError("Expecting %s items but found %s" % (count, len(value)))
        else:
            for element in value:
                _write_one(element, kind, parts, is_numpy)


def _memory(values: Any) -> bytes:
    """The bytes of an array of NumPy, of whatever numbers; those of 2.3 and later no more have the name that `genpy` asks for."""
    found: bytes = (values.tobytes if hasattr(values, "tobytes") else values.tostring)()
    return found


def _write_one(value: Any, kind: str, parts: list[bytes], is_numpy: bool) -> None:
    if kind in CODES:
        parts.append(_struct.pack("<" + CODES[kind], value))
    elif kind == "string":
        len(value)  # what has no length is another error than what cannot be encoded
        data = value.encode("utf-8")
        parts.append(_struct.pack("<I", len(data)) + data)
    elif kind in _TIMES:
        parts.append(_struct.pack("<" + _TIMES[kind][0], value.secs, value.nsecs))
    else:
        from hrdsl.interfaces import class_of

        _write(value, class_of(kind)._definition, parts, is_numpy)


def read(message: Any, data: bytes) -> Any:
    """Fills the message from bytes, and returns it."""
    reader = _Reader(data)
    try:
        reader.message(message)
        reader.flush()
    except Unpackable as error:
        raise DeserializationError(error) from None
    return message


class _Reader:
    """Reads fields. Numbers that follow each other are read together, as `genpy` does, and so are missed together."""

    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, 0
        self._form = "<"
        self._setters: list[Setter] = []  # whose value is which attribute, and how it is made of the number

    def _take(self, count: int) -> bytes:
        self._at += count
        return self._data[self._at - count : self._at]

    def _unpack(self, form: str) -> tuple[Any, ...]:
        return _struct.unpack(form, self._take(_struct.calcsize(form)))

    def _later(self, code: str, of: Any, name: str, convert: Any = None) -> None:
        self._form += code
        self._setters.append((of, name, convert))

    def flush(self) -> None:
        """Reads the numbers that are due."""
        form, setters = self._form, self._setters
        self._form, self._setters = "<", []
        if setters:
            for (of, name, convert), value in zip(setters, self._unpack(form)):
                setattr(of, name, value if convert is None else convert(value))

    def message(self, message: Any) -> None:
        for field in message._definition["fields"]:
            if "array" in field:
                self.flush()
                setattr(message, field["name"], self._array(field))
            else:
                self._one(message, field["name"], field["type"])

    def _one(self, message: Any, name: str, kind: str) -> None:
        if kind in CODES:
            self._later(CODES[kind], message, name, bool if kind == "bool" else None)
        elif kind == "string":
            self.flush()
            setattr(message, name, self._string())
        elif kind in _TIMES:
            codes, cls = _TIMES[kind]
            time: Any = cls()
            setattr(message, name, time)
            self._later(codes[0], time, "secs")
            self._later(codes[1], time, "nsecs")
        else:
            from hrdsl.interfaces import class_of

            inner = class_of(kind)()
            setattr(message, name, inner)
            self.message(inner)

    def _string(self) -> str:
        (length,) = self._unpack("<I")
        return self._take(length).decode("utf-8", "replace")

    def _array(self, field: dict[str, Any]) -> Any:
        kind, array = field["type"], field["array"]
        count = array["exactly"] if isinstance(array, dict) else self._unpack("<I")[0]
        if kind in BYTES:
            return self._take(count)
        if kind in CODES:
            found = self._unpack("<%d%s" % (count, CODES[kind]))
            return [bool(value) for value in found] if kind == "bool" else found
        holder = _Holder()
        values = []
        for _ in range(count):
            self._one(holder, "value", kind)
            self.flush()
            values.append(holder.value)
        return values


class _Holder:
    value: Any


def with_numpy(message: Any, numpy: Any) -> Any:
    """Makes arrays of numbers arrays of NumPy, which nobody can write to, in the messages within, too."""
    for field in message._definition["fields"]:
        kind, name = field["type"], field["name"]
        if kind in CODES:
            if "array" in field and kind != "bool" and kind not in BYTES:
                value = getattr(message, name)
                dtype = "<" + CODES[kind]
                setattr(message, name, numpy.frombuffer(_struct.pack("<%d%s" % (len(value), CODES[kind]), *value), dtype))
        elif "/" in kind:
            inner = getattr(message, name)
            for each in inner if "array" in field else (inner,):
                with_numpy(each, numpy)
    return message
