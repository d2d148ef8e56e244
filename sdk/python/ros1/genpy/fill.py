"""Fills messages from what YAML has: `rostopic pub` and test tools write messages so."""

from __future__ import annotations

from genpy.message import Message, MessageException, get_message_class
from genpy.rostime import TVal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Mapping

_PRIMITIVES = (
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64", "string", "bool", "char", "byte",
)  # fmt: skip


def fill(msg: Any, msg_args: list[Any] | None, keys: Mapping[str, Any]) -> None:
    """Gives the fields of a message the values of a list, one for each; or those of a dictionary by their names, which is then the
    only element. `keys` has what words such as `now` stand for where a message or a time should be. A time may be a
    dictionary, or nanoseconds as a whole number. Raises `MessageException` for fields that do not exist and values that do not fit,
    except primitive ones, which are checked when the message is sent."""
    given = [] if msg_args is None else msg_args
    _fill(msg, given[0] if len(given) == 1 and type(given[0]) is dict else given, keys, "")


def _fill(msg: Any, given: Any, keys: Mapping[str, Any], prefix: str) -> None:
    if not isinstance(msg, (Message, TVal)):
        raise ValueError("msg must be a Message instance: %s" % msg)
    if type(given) is dict:
        for name, value in given.items():
            # YAML has nothing for a key without a value; an empty text is meant.
            _fill_field(msg, name, "" if value is None else value, keys, prefix)
        return
    if type(given) is not list:
        raise ValueError("invalid msg_args type: %s" % str(given))
    names = _fields(msg)
    if len(given) != len(names):
        wrong = "Too many" if len(given) > len(names) else "Not enough"
        raise MessageException("%s arguments:\n * Given: %s\n * Expected: %s" % (wrong, given, names))
    for name, value in zip(names, given):
        _fill_field(msg, name, value, keys, prefix)


def _fields(msg: Any) -> list[str]:
    return ["secs", "nsecs"] if isinstance(msg, TVal) else msg.__slots__


def _fill_field(msg: Any, name: str, value: Any, keys: Mapping[str, Any], prefix: str) -> None:
    if name not in _fields(msg):
        raise MessageException("No field name [%s%s]" % (prefix, name))
    before = getattr(msg, name)
    if type(before) is list:
        setattr(msg, name, _elements(msg, name, value, keys, prefix))
    elif not isinstance(before, (Message, TVal)):
        setattr(msg, name, value)
    elif type(value) is str:
        if value not in keys:
            raise MessageException("No key named [%s]" % value)
        setattr(msg, name, keys[value])
    elif isinstance(before, TVal) and type(value) is int:
        setattr(msg, name, _time(type(before), value))
    else:
        _fill(before, value, keys, "%s%s." % (prefix, name))


def _elements(msg: Any, name: str, values: Any, keys: Mapping[str, Any], prefix: str) -> Any:
    """Those of an array."""
    if type(values) not in (list, tuple):
        told = "Field [%s%s] must be a list or tuple instead of: %s"
        raise MessageException(told % (prefix, name, type(values).__name__))
    kind, _, count = msg._slot_types[msg.__slots__.index(name)].partition("[")
    if count != "]" and len(values) != int(count[:-1]):
        told = "Field [%s%s] has incorrect number of elements: %s != %s"
        raise MessageException(told % (prefix, name, len(values), count[:-1]))
    if kind in _PRIMITIVES:
        return values
    made = get_message_class(kind)
    if made is None:
        told = "Cannot instantiate messages for field [%s%s] : cannot load class %s"
        raise MessageException(told % (prefix, name, kind))
    elements = []
    for value in values:
        if issubclass(made, TVal) and type(value) is int:
            elements.append(_time(made, value))
        else:
            element = made()
            _fill(element, value, keys, prefix)
            elements.append(element)
    return elements


def _time(made: Any, nanoseconds: int) -> Any:
    """As ROS makes it, by way of a float of seconds, which is not exact."""
    return made.from_sec(nanoseconds / 1e9)
