"""What the fields of ROS 2's messages are filled with, and what they accept, with rosidl's words where they do not."""

from __future__ import annotations

from array import array

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    Put = Callable[[Any, Any], None]
    Resolve = Callable[[str], type]

#: The numbers that sequences hold in an `array.array`: its code, and how the type is called in texts.
NUMBERS = {
    "float32": ("f", "float"),
    "float64": ("d", "double"),
    "int8": ("b", "int8"),
    "uint8": ("B", "uint8"),
    "char": ("B", "uint8"),
    "int16": ("h", "int16"),
    "uint16": ("H", "uint16"),
    "int32": ("i", "int32"),
    "uint32": ("I", "uint32"),
    "int64": ("q", "int64"),
    "uint64": ("Q", "uint64"),
}

_MOST = {"float32": 3.402823466e38, "float64": 1.7976931348623157e308}
_INFINITE = float("inf")


class FixedNumbers(list):  # type: ignore[type-arg]
    """Numbers of an array of a fixed size, where there is no numpy."""

    def tolist(self) -> list[Any]:
        """As numpy's."""
        return list(self)

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(
            "'list' object has no attribute %r: arrays of a fixed size are numpy arrays where numpy is installed, "
            "and lists where it is not" % name
        )


def numpy_or_none() -> Any:
    """The module, where it is installed."""
    try:
        import numpy
    except ImportError:
        return None
    return numpy


def is_message(field: dict[str, Any]) -> bool:
    """Whether the field holds messages."""
    return "/" in field["type"]


def prepared(field: dict[str, Any]) -> str | None:
    """What the constructor makes of any iterable for this field: an `array`, a `fixed` one, or nothing."""
    if "array" not in field or field["type"] not in NUMBERS:
        return None
    size = field["array"]
    return "fixed" if isinstance(size, dict) and "exactly" in size else "array"


def type_text(field: dict[str, Any]) -> str:
    """The field's type as `get_fields_and_field_types` tells it."""
    kind = field["type"]
    if "/" in kind:
        parts = kind.split("/")
        text = "%s/%s" % (parts[0], parts[-1])
    elif kind in NUMBERS:
        text = NUMBERS[kind][1]
    else:
        text = {"bool": "boolean", "byte": "octet"}.get(kind, kind)
    if "characters" in field:
        text += "<%d>" % field["characters"]
    size = field.get("array")
    if size is None:
        return str(text)
    if size == "any":
        return "sequence<%s>" % text
    if "exactly" in size:
        return "%s[%d]" % (text, size["exactly"])
    return "sequence<%s, %d>" % (text, size["at_most"])


def converter_of(field: dict[str, Any]) -> Callable[[Any], Any]:
    """Makes numbers of any iterable, as the constructor does."""
    code, kind = NUMBERS[field["type"]]
    if prepared(field) == "array":
        return lambda values: array(code, values)
    count = field["array"]["exactly"]

    def convert(values: Any) -> Any:
        made = fixed(field["type"], values)
        if len(made) != count:
            raise AssertionError
        return made

    return convert


def fixed(kind: str, values: Any) -> Any:
    """Numbers of a fixed size: a numpy array where there is numpy."""
    numpy = numpy_or_none()
    if numpy is not None:
        return numpy.array(values, dtype=_dtype(kind))
    return FixedNumbers(array(NUMBERS[kind][0], values))


def _dtype(kind: str) -> str:
    return "uint8" if kind == "char" else kind


def blank_of(field: dict[str, Any], resolve: Resolve) -> tuple[Any, bool, Any]:
    """What a new message has in a field: the value, or what makes it, and whether it has to be made; and one such."""
    kind, size = field["type"], field.get("array")
    if "default" in field:
        value = _read(kind, field["default"], size)
        if size is None:
            return value, False, value
        if kind in NUMBERS:
            convert = converter_of(field)
            return (lambda: convert(value)), True, value
        return (lambda: list(value)), True, value
    if size is None:
        if is_message(field):
            return resolve(kind), True, None
        return _zero(kind), False, None
    count = size["exactly"] if isinstance(size, dict) and "exactly" in size else 0
    if kind in NUMBERS:
        if prepared(field) == "array":
            return (lambda code=NUMBERS[kind][0]: array(code)), True, None
        return (lambda: fixed(kind, [_zero(kind)] * count)), True, None
    if is_message(field):
        if not count:
            return list, True, None
        cls = resolve(kind)
        return (lambda: [cls() for _ in range(count)]), True, None
    return (lambda: [_zero(kind)] * count), True, None


def _zero(kind: str) -> Any:
    if kind in _MOST:
        return 0.0
    return {"bool": False, "byte": b"\x00", "string": "", "wstring": ""}.get(kind, 0)


def _read(kind: str, value: Any, size: Any) -> Any:
    if size is not None:
        return [_read(kind, each, None) for each in value]
    if kind in _MOST:
        return float(value)
    return bytes([value]) if kind == "byte" else value


# ── setting a field ──


def setter_of(field: dict[str, Any], put: Put, resolve: Resolve) -> Callable[[Any, Any], None]:
    """The setter of the field's property, which checks the value before it puts it."""
    if "array" in field:
        return _many(field, put, resolve)
    kind, name = field["type"], field["name"]
    if is_message(field):
        return _message(name, resolve(kind), put)
    if kind in _MOST:
        return _float(name, kind, put)
    if kind in NUMBERS:
        return _integer(name, kind, put)
    if "characters" in field:
        return _bounded(name, field["characters"], put)
    return _plain(name, kind, put)


def _message(name: str, cls: type, put: Put) -> Callable[[Any, Any], None]:
    def set_message(self: Any, value: Any) -> None:
        if not isinstance(value, cls):
            raise AssertionError("The '%s' field must be a sub message of type '%s'" % (name, cls.__name__))
        put(self, value)

    return set_message


def _float(name: str, kind: str, put: Put) -> Callable[[Any, Any], None]:
    bound = _MOST[kind]

    def set_float(self: Any, value: Any) -> None:
        if not isinstance(value, float):
            raise AssertionError("The '%s' field must be of type 'float'" % name)
        if (value < -bound or value > bound) and abs(value) != _INFINITE:
            raise AssertionError(
                "The '%s' field must be a %s in [%s, %s]" % (name, NUMBERS[kind][1], -bound, bound)
            )
        put(self, value)

    return set_float


def _limits(kind: str) -> tuple[int, int]:
    kind = NUMBERS[kind][1]
    if kind.startswith("u"):
        return 0, 2 ** int(kind[4:]) - 1
    bound = 2 ** (int(kind[3:]) - 1)
    return -bound, bound - 1


def _integer(name: str, kind: str, put: Put) -> Callable[[Any, Any], None]:
    low, high = _limits(kind)
    what = "an unsigned integer" if low == 0 else "an integer"

    def set_integer(self: Any, value: Any) -> None:
        if not isinstance(value, int):
            raise AssertionError("The '%s' field must be of type 'int'" % name)
        if not low <= value <= high:
            raise AssertionError("The '%s' field must be %s in [%d, %d]" % (name, what, low, high))
        put(self, value)

    return set_integer


def _bounded(name: str, most: int, put: Put) -> Callable[[Any, Any], None]:
    def set_bounded(self: Any, value: Any) -> None:
        if not _is_text(value) or len(value) > most:
            raise AssertionError("The '%s' field must be string value not longer than %d" % (name, most))
        put(self, value)

    return set_bounded


def _plain(name: str, kind: str, put: Put) -> Callable[[Any, Any], None]:
    wanted = bool if kind == "bool" else str

    def set_byte(self: Any, value: Any) -> None:
        if not isinstance(value, (bytes, bytearray)) or len(value) != 1:
            raise AssertionError("The '%s' field must be of type 'bytes' or 'ByteString' with length 1" % name)
        put(self, value)

    def set_plain(self: Any, value: Any) -> None:
        if not isinstance(value, wanted):
            raise AssertionError("The '%s' field must be of type '%s'" % (name, wanted.__name__))
        put(self, value)

    return set_byte if kind == "byte" else set_plain


def _is_text(value: Any) -> bool:
    if isinstance(value, str):
        return True
    from collections import UserString

    return isinstance(value, UserString)


def _many(field: dict[str, Any], put: Put, resolve: Resolve) -> Callable[[Any, Any], None]:
    kind, name, size = field["type"], field["name"], field["array"]
    code = NUMBERS[kind][0] if kind in NUMBERS else ""
    most = size.get("at_most") if isinstance(size, dict) else None
    made = prepared(field)

    def set_many(self: Any, value: Any) -> None:
        if made == "array":
            if isinstance(value, array):
                if value.typecode != code:
                    raise AssertionError("The '%s' array.array() must have the type code of '%s'" % (name, code))
                if most is not None and len(value) > most:
                    raise AssertionError("The '%s' array.array() must have a size <= %d" % (name, most))
                put(self, value)
                return
            _check_many(field, value, resolve)
            value = array(code, value)
        elif made == "fixed":
            if not _is_fixed(field, value):
                _check_many(field, value, resolve)
                value = fixed(kind, value)
        else:
            _check_many(field, value, resolve)
        put(self, value)

    return set_many


def _is_fixed(field: dict[str, Any], value: Any) -> bool:
    """Whether it is a numpy array, which has to be of the right kind then."""
    if type(value).__module__ != "numpy" or type(value).__name__ != "ndarray":
        return False
    name, kind, count = field["name"], _dtype(field["type"]), field["array"]["exactly"]
    if value.dtype != kind:
        raise AssertionError("The '%s' numpy.ndarray() must have the dtype of 'numpy.%s'" % (name, kind))
    if value.size != count:
        raise AssertionError("The '%s' numpy.ndarray() must have a size of %d" % (name, count))
    return True


def _check_many(field: dict[str, Any], value: Any, resolve: Resolve) -> None:
    """Refuses what is no sequence of such values."""
    kind, size = field["type"], field["array"]
    element: type
    if is_message(field):
        element = resolve(kind)
    else:
        element = float if kind in _MOST else int if kind in NUMBERS else {"bool": bool, "byte": bytes}.get(kind, str)
    fits = isinstance(value, (list, tuple)) or _is_sequence(value)
    if fits and "characters" in field:
        fits = all(len(each) <= field["characters"] for each in value)
    if fits and isinstance(size, dict):
        fits = len(value) == size["exactly"] if "exactly" in size else len(value) <= size["at_most"]
    fits = fits and all(isinstance(each, element) for each in value)
    if fits and kind in _MOST:
        bound = _MOST[kind]
        fits = all(not (each < -bound or each > bound) or abs(each) == _INFINITE for each in value)
    elif fits and kind in NUMBERS:
        low, high = _limits(kind)
        fits = all(low <= each <= high for each in value)
    if not fits:
        raise AssertionError("The '%s' field must be %s" % (field["name"], _wanted(field, element)))


def _is_sequence(value: Any) -> bool:
    from collections import UserList
    from collections.abc import Sequence, Set

    return isinstance(value, (Sequence, Set, UserList)) and not _is_text(value)


def _wanted(field: dict[str, Any], element: type) -> str:
    kind, size = field["type"], field["array"]
    parts = ["a set or sequence"]
    if isinstance(size, dict):
        parts.append("with length %d" % size["exactly"] if "exactly" in size else "with length <= %d" % size["at_most"])
    if "characters" in field:
        parts.append("and each string value not longer than %d" % field["characters"])
    parts.append("and each value of type '%s'" % element.__name__)
    if kind in _MOST:
        parts.append("and each %s in [%f, %f]" % (NUMBERS[kind][1], -_MOST[kind], _MOST[kind]))
    elif kind in NUMBERS:
        low, high = _limits(kind)
        parts.append("and each %s in [%d, %d]" % ("unsigned integer" if low == 0 else "integer", low, high))
    return " ".join(parts)
