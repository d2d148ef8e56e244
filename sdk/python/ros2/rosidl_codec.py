"""Messages of ROS 2 as JSON, and back: for each class one function that is compiled when it is first needed.

The JSON is that of the harness: an object with every field; `byte` is a number, and floats that JSON does not have are
`"nan"`, `"inf"` and `"-inf"`. A float32 is rounded as it would be on the wire.
"""

from __future__ import annotations

import json
from array import array
from struct import Struct

from rosidl_setters import NUMBERS, fixed, prepared

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    Resolve = Callable[[str], type]

quoted = json.encoder.encode_basestring_ascii
_INFINITE = float("inf")
_single = Struct("<f")
_float_text = float.__repr__  # not `repr`, which tells numpy's floats otherwise


def _odd(value: float) -> str:
    return '"nan"' if value != value else '"inf"' if value > 0 else '"-inf"'


def _double(value: float) -> str:
    return _float_text(value) if -_INFINITE < value < _INFINITE else _odd(value)


def _rounded(value: float) -> float:
    try:
        return float(_single.unpack(_single.pack(value))[0])
    except OverflowError:
        return _INFINITE if value > 0 else -_INFINITE


def _float(value: float) -> str:
    return _double(_rounded(value))


def _floats(values: Any) -> str:
    text = ",".join([_float_text(float(value)) for value in values])
    if "n" in text:  # there is a nan or an inf, which no number's text has
        text = ",".join([_double(float(value)) for value in values])
    return "[%s]" % text


def _singles(values: Any) -> str:
    return _floats(values if isinstance(values, array) else array("f", values))


def _integers(values: Any) -> str:
    return "[%s]" % ",".join(["%d" % value for value in values])


def _byte(value: bytes) -> str:
    return "%d" % value[0]


def _truth(value: Any) -> str:
    return "true" if value else "false"


def _each(one: Callable[[Any], str]) -> Callable[[Any], str]:
    def many(values: Any) -> str:
        return "[%s]" % ",".join([one(value) for value in values])

    return many


def _numbers(code: str) -> Callable[[Any], Any]:
    def many(values: Any) -> Any:
        try:
            return array(code, values)
        except TypeError:  # a nan or an inf, which are texts
            return array(code, map(float, values))

    return many


class Codec:
    """Writes and reads the messages of one class."""

    __slots__ = ("_definition", "_resolve", "encode", "decode")

    def __init__(self, definition: dict[str, Any], resolve: Resolve) -> None:
        self._definition = definition
        self._resolve = resolve
        self.encode: Callable[[Any], str] = self._first_encode
        self.decode: Callable[[Any], Any] = self._first_decode

    def _first_encode(self, message: Any) -> str:
        self.encode = self._compiled_encode()
        return self.encode(message)

    def _first_decode(self, value: Any) -> Any:
        self.decode = self._compiled_decode(self._resolve(self._definition["name"]))
        return self.decode(value)

    def _compiled_encode(self) -> Callable[[Any], str]:
        scope: dict[str, Any] = {}
        forms, values = [], []
        for place, field in enumerate(self._definition["fields"]):
            form, value = self._writer(field, "m._%s" % field["name"], "w%d" % place, scope)
            forms.append("%s:%s" % (quoted(field["name"]), form))
            values.append(value)
        text = "lambda m: %r" % ("{%s}" % ",".join(forms))
        if values:
            text += " %% (%s,)" % ", ".join(values)
        return eval(text, scope)  # type: ignore[no-any-return]

    def _writer(self, field: dict[str, Any], place: str, name: str, scope: dict[str, Any]) -> tuple[str, str]:
        """How a field is formatted, and the value for it, as Python."""
        kind = field["type"]
        one: Any
        if kind == "float64" and "array" not in field:  # without a call of a function in Python
            scope.update(text=_float_text, odd=_odd, inf=_INFINITE)
            return "%s", "text(v) if -inf < (v := %s) < inf else odd(v)" % place
        if "/" in kind:
            codec = self._resolve(kind)._codec_  # type: ignore[attr-defined]
            one = lambda message: codec.encode(message)  # noqa: E731  # it changes with its first use
        elif kind == "float64":
            one = _double
        elif kind == "float32":
            one = _float
        elif kind in NUMBERS:
            if "array" not in field:
                return "%d", place
            one = None
        else:
            one = {"bool": _truth, "byte": _byte}.get(kind) or (lambda text: quoted(str(text)))
        if "array" in field:
            scope[name] = (
                _floats if kind == "float64" else _singles if kind == "float32" else _integers if one is None else _each(one)
            )
        else:
            scope[name] = quoted if kind in ("string", "wstring") and "characters" not in field else one
        return "%s", "%s(%s)" % (name, place)

    def _compiled_decode(self, cls: type) -> Callable[[Any], Any]:
        scope: dict[str, Any] = {"cls": cls, "new": cls.__new__}
        lines = ["def decode(v):", " m = new(cls)"]
        for place, field in enumerate(self._definition["fields"]):
            name = "r%d" % place
            scope[name] = self._reader(field)
            value = "v[%r]" % field["name"]
            lines.append(" m._%s = %s" % (field["name"], value if scope[name] is None else "%s(%s)" % (name, value)))
        lines.append(" return m")
        exec("\n".join(lines), scope)
        return scope["decode"]  # type: ignore[no-any-return]

    def _reader(self, field: dict[str, Any]) -> Any:
        kind = field["type"]
        if "array" in field:
            made = prepared(field)
            if made == "array":
                return _numbers(NUMBERS[kind][0])
            if made == "fixed":
                convert = float if kind.startswith("float") else int
                return lambda values: fixed(kind, [convert(value) for value in values])
        one: Any = None
        if "/" in kind:
            codec = self._resolve(kind)._codec_  # type: ignore[attr-defined]
            one = lambda value: codec.decode(value)  # noqa: E731  # it changes with its first use
        elif kind == "float64":
            one = float
        elif kind == "float32":
            one = lambda value: _rounded(float(value))  # noqa: E731
        elif kind == "byte":
            one = lambda value: bytes([value])  # noqa: E731
        if "array" not in field:
            return one
        return list if one is None else lambda values: [one(value) for value in values]
