"""Values of fields to and from JSON. What is written raises what packing them for the wire would raise."""

from __future__ import annotations

import _struct
import json
from json.encoder import encode_basestring_ascii

from genpy.message import DeserializationError, MessageException, SerializationError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

#: Of numbers in arrays, as `struct` calls them.
CODES = {
    "bool": "B", "byte": "b", "int8": "b", "uint8": "B", "char": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip

#: Which numbers arrays hold as bytes.
BYTES = ("uint8", "char")

#: What packing raises.
Unpackable = _struct.error

_pack = _struct.pack
_unpack = _struct.unpack
_dumps = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode
_float_text = float.__repr__
_SINGLE = _struct.Struct("<f")
_WORDS = {"inf": '"inf"', "-inf": '"-inf"', "nan": '"nan"'}


def real(value: Any) -> str:
    """A float."""
    if value.__class__ is not float:
        (value,) = _unpack("<d", _pack("<d", value))
    text = _float_text(value)
    return text if value - value == 0.0 else _WORDS[text]


def whole(value: Any, low: int, high: int) -> str:
    """A whole number between these."""
    if value.__class__ is not int:
        value = value.__index__() if hasattr(value, "__index__") else _not_whole()
    if not low <= value <= high:
        raise _struct.error("argument out of range")
    return "%d" % value


def _not_whole() -> NoReturn:
    raise _struct.error("required argument is not an integer")


def truth(value: Any) -> str:
    """A boolean, for which whole numbers pass."""
    if value is True or value is False:
        return "true" if value else "false"
    return "false" if whole(value, 0, 255) == "0" else "true"


def text(value: Any) -> str:
    """A string."""
    if value.__class__ is str:
        return encode_basestring_ascii(value)
    len(value)  # what has no length is another error than what cannot be encoded
    return encode_basestring_ascii(value.encode("utf-8").decode("utf-8"))


def time(value: Any) -> str:
    """A time or duration."""
    return '{"secs":%d,"nsecs":%d}' % (value.secs, value.nsecs)


def numbers(values: Any, kind: str, count: int | None) -> str:
    """An array of numbers."""
    code = CODES[kind]
    if kind in BYTES and type(values) not in (list, tuple):
        return "[%s]" % ",".join(map(str, packed_bytes(values, count)))
    length = len(values) if count is None else count
    form = "<%d%s" % (length, code)
    found = _unpack(form, _pack(form, *values))
    if kind == "bool":
        return _dumps([bool(value) for value in found])
    try:
        return _dumps(found)
    except ValueError:  # some are not finite
        return "[%s]" % ",".join(map(real, found))


class Unwritten(ValueError):
    """Bytes that cannot be written, with what was given in their place."""

    def __init__(self, told: str, given: Any) -> None:
        super().__init__(told)
        self.given = given


def packed_bytes(values: Any, count: int | None) -> bytes:
    """An array of bytes that is given as such; a text is none."""
    try:
        return _struct.pack("%ds" % (len(values) if count is None else count), values)
    except Unpackable as error:
        raise Unwritten(str(error), values) from None


def array(values: Any, one: Callable[[Any], str], count: int | None) -> str:
    """An array of anything else."""
    if count is not None and len(values) != count:
        raise ValueError("Expecting %s items but found %s" % (count, len(values)))
    return "[%s]" % ",".join([one(value) for value in values])


def failed(message: Any, error: Exception) -> NoReturn:
    """Says which field does not fit."""
    if isinstance(error, OverflowError):
        raise error
    kind: Any = Unpackable if isinstance(error, Unwritten) else type(error)
    given = error.given if isinstance(error, Unwritten) else message
    message._check_types(ValueError("%s: '%s' when writing '%s'" % (kind, error, given)))
    raise SerializationError(str(error))


# ── reading ──


def read_double(value: Any) -> float:
    return value if value.__class__ is float else float(value)


def read_single(value: Any) -> float:
    """As it is after it was a number of 32 bits."""
    try:
        found: float = _SINGLE.unpack(_SINGLE.pack(value))[0]
        return found
    except _struct.error:  # a word
        return float(value)


def read_time(cls: Any, value: Any) -> Any:
    made = cls.__new__(cls)
    made.secs, made.nsecs = value["secs"], value["nsecs"]
    return made


def read_numbers(values: Any, kind: str, count: int | None) -> Any:
    """An array of numbers as `genpy` reads it from the wire: a tuple, bytes, or a list of booleans."""
    if count is not None and len(values) != count:
        raise ValueError("%d values, not %d" % (len(values), count))
    code = CODES[kind]
    if kind == "bool":
        return [bool(value) for value in values]
    if kind in BYTES:
        return bytes(values)
    form = "<%d%s" % (len(values), code)
    try:
        return _unpack(form, _pack(form, *values))
    except _struct.error:
        if code not in "fd":
            raise ValueError("values that are no %s" % kind) from None
        return _unpack(form, _pack(form, *map(float, values)))  # of which some are words


def misread(cls: Any, error: Exception) -> NoReturn:
    """Says what is no message of the class."""
    if isinstance(error, MessageException):
        raise error
    what = "there is no field %s" % error if isinstance(error, KeyError) else str(error)
    raise DeserializationError("no %s: %s" % (cls._type, what))
