"""The base of all messages, how they are printed, and what is said of fields with values that do not fit."""

from __future__ import annotations

import _struct

from genpy.rostime import Duration, Time, TVal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

struct_I = _struct.Struct("<I")

_WIDTHS = {
    "byte": 8, "char": 8, "int8": 8, "uint8": 8, "int16": 16, "uint16": 16, "int32": 32, "uint32": 32, "int64": 64, "uint64": 64,
}  # fmt: skip
_SIGNED = ("byte", "int8", "int16", "int32", "int64")
_HEADERS = ("Header", "std_msgs/Header", "roslib/Header")


class MessageException(Exception):
    """The base of errors about messages."""


class DeserializationError(MessageException):
    """Bytes that are no message of the type."""


class SerializationError(MessageException):
    """A message with values that its type does not allow."""


class Message:
    """The base of all messages. Classes of messages have the names of their fields in `__slots__`."""

    __slots__ = ["_connection_header"]

    _type = ""
    _md5sum = ""
    _full_text = ""
    _has_header = False
    _float_text: bytes | None = None  # if a float is all that it holds: its JSON, with a place for a finite one
    _slot_types: list[str] = []
    _definition: dict[str, Any] = {}
    _json: Callable[[Any], str]  # of a message
    _of_json: Callable[[Any], Any]  # the message of a value as JSON has it

    def __init__(self, *args: Any, **kwds: Any) -> None:
        if args and kwds:
            raise TypeError("Message constructor may only use args OR keywords, not both")
        names = self.__slots__
        if args:
            if len(args) != len(names):
                told = "Invalid number of arguments, args should be %s" % str(names) + " args are" + str(args)
                raise TypeError(told)
            for name, value in zip(names, args):
                setattr(self, name, value)
            return
        for name in kwds:
            if name not in names:
                raise AttributeError("%s is not an attribute of %s" % (name, self.__class__.__name__))
        for name in names:
            setattr(self, name, kwds.get(name))

    def __getstate__(self) -> list[Any]:
        return [getattr(self, name) for name in self.__slots__]

    def __setstate__(self, state: list[Any]) -> None:
        for name, value in zip(self.__slots__, state):
            setattr(self, name, value)

    def _get_types(self) -> list[str]:
        return self._slot_types

    def _check_types(self, exc: BaseException | None = None) -> None:
        """Raises `SerializationError` for the first field whose value does not fit; if all do, for the given error."""
        for name, kind in zip(self.__slots__, self._get_types()):
            check_type(name, kind, getattr(self, name))
        if exc:
            raise SerializationError(str(exc))

    def serialize(self, buff: Any) -> None:
        """Writes it to a file of bytes, as ROS does on the wire."""
        from genpy import wire

        wire.write(self, buff)

    def deserialize(self, str: bytes) -> Any:
        """Reads its fields from bytes."""
        from genpy import wire

        return wire.read(self, str)

    def serialize_numpy(self, buff: Any, numpy: Any) -> None:
        """As `serialize`, of arrays of NumPy, whose bytes are written whatever their numbers are."""
        from genpy import wire

        wire.write(self, buff, is_numpy=True)

    def deserialize_numpy(self, str: bytes, numpy: Any) -> Any:
        """As `deserialize`, with arrays of NumPy."""
        from genpy import wire

        return wire.with_numpy(wire.read(self, str), numpy)

    def __repr__(self) -> str:
        return strify_message(self)

    def __str__(self) -> str:
        return strify_message(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, self.__class__):
            return False
        for name in self.__slots__:
            mine: Any = getattr(self, name, None)
            its: Any = getattr(other, name, None)
            if type(mine) in (list, tuple) and type(its) in (list, tuple):
                mine, its = tuple(mine), tuple(its)
            if not mine == its:
                return False
        return True

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment]


# ── what does not fit ──


def check_type(field_name: str, field_type: str, field_val: Any) -> None:
    """Raises `SerializationError` if the value is none of the type."""
    if field_type in _WIDTHS:
        _check_whole(field_name, field_type, field_val)
    elif field_type in ("float32", "float64"):
        if type(field_val) not in (float, int) and type(field_val).__module__ != "numpy":
            raise SerializationError("field %s must be float type" % field_name)
    elif field_type == "bool":
        if field_val not in [True, False, 0, 1]:
            raise SerializationError("field %s is not a bool" % field_name)
    elif field_type == "string":
        if type(field_val) is str:
            if not field_val.isascii():
                raise SerializationError("field %s is a non-ascii string" % field_name)
        elif type(field_val) is not bytes:
            raise SerializationError("field %s must be of type bytes or an ascii string" % field_name)
    elif field_type == "time":
        if not isinstance(field_val, Time):
            raise SerializationError("field %s must be of type Time" % field_name)
    elif field_type == "duration":
        if not isinstance(field_val, Duration):
            raise SerializationError("field %s must be of type Duration" % field_name)
    elif field_type.endswith("]"):
        _check_array(field_name, field_type[: field_type.index("[")], field_val)
    else:
        _check_message(field_name, field_type, field_val)


def _check_whole(name: str, kind: str, value: Any) -> None:
    if kind in _SIGNED:
        if type(value) is not int:
            raise SerializationError("field %s must be an integer type" % name)
        bound = 1 << (_WIDTHS[kind] - 1)
        is_beyond = not -bound <= value < bound
    else:
        if type(value) is not int or value < 0:
            raise SerializationError("field %s must be unsigned integer type" % name)
        is_beyond = value >= 1 << _WIDTHS[kind]
    if is_beyond:
        raise SerializationError("field %s exceeds specified width [%s]" % (name, kind))


def _check_array(name: str, kind: str, value: Any) -> None:
    if type(value) in (bytes, str):
        if kind not in ("char", "uint8"):
            raise SerializationError("field %s must be a list or tuple type. Only uint8[] can be a string" % name)
        return
    if type(value) not in (list, tuple):
        raise SerializationError("field %s must be a list or tuple type" % name)
    for element in value:
        check_type(name + "[]", kind, element)


def _check_message(name: str, kind: str, value: Any) -> None:
    if not isinstance(value, Message):
        raise SerializationError("field %s must be of type [%s]" % (name, kind))
    if value._type in _HEADERS:
        if kind not in _HEADERS:
            raise SerializationError("field %s must be a Header instead of a %s" % (name, value._type))
    elif value._type != kind:
        raise SerializationError("field %s must be of type %s instead of %s" % (name, kind, value._type))
    for inner, of in zip(value.__slots__, value._get_types()):
        check_type("%s.%s" % (name, inner), of, getattr(value, inner))


# ── as text ──


def strify_message(
    val: Any, indent: str = "", time_offset: Any = None, current_time: Any = None, field_filter: Any = None,
    fixed_numeric_width: int | None = None,
) -> str:  # fmt: skip
    """The text of a value in the style of YAML; with an indent, messages begin on a new line."""
    options = (time_offset, current_time, field_filter, fixed_numeric_width)
    kind = type(val)
    if kind in (int, float, bool):
        return _number(val, fixed_numeric_width)
    if isinstance(val, str):
        from genpy import yaml_text

        return yaml_text.quoted(val) if val else "''"
    if isinstance(val, TVal):
        return _time(val, indent, time_offset, fixed_numeric_width)
    if kind in (list, tuple):
        return _list(val, indent, options)
    if not isinstance(val, Message):
        return str(val)
    names = val.__slots__ if field_filter is None else list(field_filter(val))
    lines = []
    for name, of in zip(val.__slots__, val._slot_types):
        if name in names:
            value = getattr(val, name)
            if isinstance(value, bytes) and "uint8[" in of:
                value = list(value)
            lines.append("%s%s: %s" % (indent, name, strify_message(value, "  " + indent, *options)))
    return ("\n" if indent else "") + "\n".join(lines)


def _number(value: Any, width: int | None) -> str:
    if width is None or type(value) is bool:
        return str(value)
    if type(value) is float:
        text = "%.*f" % (width, value)
        return text[: max(text.find("."), width)]
    return "%*d" % (width, value)


def _time(value: TVal, indent: str, offset: Any, width: int | None) -> str:
    if offset is not None and isinstance(value, Time):
        value = value - offset
    if width is not None:
        return "\n%ssecs: %*d\n%snsecs: %*d" % (indent, width, value.secs, indent, width, value.nsecs)
    return "\n%ssecs: %s\n%snsecs: %9d" % (indent, value.secs, indent, value.nsecs)


def _list(values: Any, indent: str, options: Any) -> str:
    if not values:
        return "[]"
    first = values[0]
    if type(first) in (int, float) and options[3] is not None:
        return "[" + ", ".join(strify_message(value, indent, *options) for value in values) + "]"
    if isinstance(first, str):
        from genpy import yaml_text

        return "".join("\n%s%s" % (indent, line) for line in yaml_text.items(values))
    if type(first) in (int, float, bool):
        return str(list(values))
    return "".join("\n%s- %s" % (indent, strify_message(value, indent + "  ", *options)) for value in values)


# ── by name ──


def get_message_class(message_type: str, reload_on_error: bool = False) -> Any:
    """The class of a message by its name; None if it is not known."""
    if message_type in ("time", "duration"):
        return Time if message_type == "time" else Duration
    return _class("msg", "std_msgs/Header" if message_type == "Header" else message_type)


def get_service_class(service_type: str, reload_on_error: bool = False) -> Any:
    """The class of a service by its name; None if it is not known."""
    return _class("srv", service_type)


def _class(space: str, name: str) -> Any:
    from hrdsl.interfaces import interfaces

    package, _, own = name.partition("/")
    if not own:
        raise ValueError("message type is missing package name: %s" % name)
    if "/" in own:
        raise ValueError("invalid name [%s]" % name)
    known = interfaces()
    spaces = ("msg", "srv") if space == "msg" else ("srv",)
    for each in spaces:
        found = known.spaces.get("%s.%s" % (package, each), {}).get(own)
        if found is not None:
            return known.class_of(*found)
    return None


# ── from what YAML has ──


def fill_message_args(msg: Any, msg_args: list[Any] | None, keys: dict[str, Any] = {}) -> None:
    """Gives a message's fields their values, see `genpy.fill`, which few programs need."""
    from genpy.fill import fill

    fill(msg, msg_args, keys)
