"""Makes the classes of messages and services from their definitions. What runs for each message that is sent or received is a
function written for its class: a text in Python that names every field."""

from __future__ import annotations

import keyword

from genpy import values
from genpy.message import Message
from genpy.rostime import Duration, Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    Resolve = Callable[[str], Any]

_LIMITS = {
    "int8": (-(1 << 7), (1 << 7) - 1), "byte": (-(1 << 7), (1 << 7) - 1), "int16": (-(1 << 15), (1 << 15) - 1),
    "int32": (-(1 << 31), (1 << 31) - 1), "int64": (-(1 << 63), (1 << 63) - 1), "uint8": (0, (1 << 8) - 1),
    "char": (0, (1 << 8) - 1), "uint16": (0, (1 << 16) - 1), "uint32": (0, (1 << 32) - 1), "uint64": (0, (1 << 64) - 1),
}  # fmt: skip
_FLOATS = ("float32", "float64")


def make_class(definition: dict[str, Any], resolve: Resolve) -> Any:
    """The class of a message; `resolve` finds those of the messages in it by their names."""
    fields = [_Field(field, at, resolve) for at, field in enumerate(definition["fields"])]
    package, name = definition["name"].split("/")
    namespace: dict[str, Any] = {
        "__slots__": [field.name for field in fields],
        "__module__": "%s.%s._%s" % (package, definition["space"], _file(definition, name)),
        "_type": definition["name"],
        "_md5sum": definition.get("md5", ""),
        "_full_text": _FullText(definition, resolve),
        "_has_header": any(f.name == "header" and f.type == "std_msgs/Header" and f.array is None for f in fields),
        "_float_text": _float_text(fields),
        "_slot_types": [field.text() for field in fields],
        "_definition": definition,
    }
    for constant in definition["constants"]:
        namespace[constant["name"]] = _constant(constant)
    namespace.update(_functions(fields))
    cls: Any = type(name, (Message,), namespace)
    cls._of_json = _reader(cls, fields)
    return cls


def make_service(definition: dict[str, Any], resolve: Resolve) -> Any:
    """The class of a service, which names those of its request and response."""
    package, name = definition["name"].split("/")
    return type(name, (), {
        "__module__": "%s.srv._%s" % (package, name),
        "_type": definition["name"],
        "_md5sum": definition.get("md5", ""),
        "_request_class": resolve(definition["request"]),
        "_response_class": resolve(definition["response"]),
    })  # fmt: skip


def _file(definition: dict[str, Any], name: str) -> str:
    if definition["space"] == "srv":
        for end in ("Request", "Response"):
            if name.endswith(end):
                return name[: -len(end)]
    return name


def _constant(constant: dict[str, Any]) -> Any:
    value = constant["value"]
    return float(value) if constant["type"] in _FLOATS else value


class _FullText:
    """The definition with those of all messages in it, put together when it is asked for."""

    def __init__(self, definition: dict[str, Any], resolve: Resolve) -> None:
        self._definition, self._resolve = definition, resolve

    def __get__(self, instance: Any, owner: Any = None) -> str:
        text: str = self._definition["text"]
        for name in self._definition["holds"]:
            text += "\n%s\nMSG: %s\n%s" % ("=" * 80, name, self._resolve(name)._definition["text"])
        return text


class _Field:
    """A field, and the pieces of program that it needs."""

    def __init__(self, field: dict[str, Any], at: int, resolve: Resolve) -> None:
        self.name: str = field["name"]
        self.type: str = field["type"]
        self.array = field.get("array")
        self.exactly = self.array["exactly"] if isinstance(self.array, dict) else None
        self.at = at
        self.cls = resolve(self.type) if "/" in self.type else {"time": Time, "duration": Duration}.get(self.type)
        self.is_simple = not keyword.iskeyword(self.name)

    def text(self) -> str:
        """Its type as it is written."""
        if self.array is None:
            return self.type
        return "%s[%s]" % (self.type, "" if self.exactly is None else self.exactly)

    def get(self, of: str = "m") -> str:
        return "%s.%s" % (of, self.name) if self.is_simple else "getattr(%s, %r)" % (of, self.name)

    def put(self, value: str, of: str = "m") -> str:
        if self.is_simple:
            return "%s.%s = %s" % (of, self.name, value)
        return "setattr(%s, %r, %s)" % (of, self.name, value)

    def default(self) -> str:
        """A new value for it."""
        if self.array is not None and self.exactly is None:
            return "b''" if self.type in values.BYTES else "[]"
        one = self._default_of_one()
        if self.array is None:
            return one
        if self.type in values.BYTES:
            return repr(b"\0" * self.exactly)
        if self.cls is not None:
            return "[%s for _ in range(%d)]" % (one, self.exactly)
        return "[%s] * %d" % (one, self.exactly)

    def _default_of_one(self) -> str:
        if self.cls is not None:
            return "C%d()" % self.at
        return {"bool": "False", "string": "''", "float32": "0.", "float64": "0."}.get(self.type, "0")

    def written(self) -> str:
        """An expression for its text as JSON, which raises what `genpy` would catch if the value does not fit."""
        value = self.get()
        if self.array is not None:
            return self._written_array(value)
        if self.type in _LIMITS:
            return "W(%s, %d, %d)" % (value, *_LIMITS[self.type])
        if self.type in _FLOATS:
            return "F(%s)" % value
        if self.type in ("bool", "string", "time", "duration"):
            return "%s(%s)" % ({"bool": "B", "string": "S"}.get(self.type, "T"), value)
        return "C%d._json(%s)" % (self.at, value)

    def _written_array(self, value: str) -> str:
        if self.type in values.CODES:
            return "N(%s, %r, %r)" % (value, self.type, self.exactly)
        one = "C%d._json" % self.at if "/" in self.type else "S" if self.type == "string" else "T"
        return "A(%s, %s, %r)" % (value, one, self.exactly)

    def read(self) -> str:
        """An expression for its value, from `d[name]`."""
        value = "d[%r]" % self.name
        if self.array is not None:
            if self.type in values.CODES:
                return "RN(%s, %r, %r)" % (value, self.type, self.exactly)
            if self.type == "string":
                return "list(%s)" % value
            return "[%s for d in %s]" % (self._read_one("d"), value)
        return self._read_one(value)

    def _read_one(self, value: str) -> str:
        if self.type in _FLOATS:
            return "%s(%s)" % ("R32" if self.type == "float32" else "R64", value)
        if self.type in ("time", "duration"):
            return "RT(C%d, %s)" % (self.at, value)
        return "C%d._of_json(%s)" % (self.at, value) if self.cls is not None else value


def _float_text(fields: list[_Field]) -> bytes | None:
    if len(fields) == 1 and fields[0].array is None and fields[0].type in _FLOATS:
        return b'{"%s":%%r}' % fields[0].name.encode("ascii")
    return None


def _functions(fields: list[_Field]) -> dict[str, Any]:
    """`__init__` and `_json`."""
    names: dict[str, Any] = {
        "Message": Message, "W": values.whole, "F": values.real, "B": values.truth, "S": values.text, "T": values.time,
        "N": values.numbers, "A": values.array, "failed": values.failed, "Unpackable": values.Unpackable,
    }  # fmt: skip
    names.update(("C%d" % field.at, field.cls) for field in fields if field.cls is not None)
    found: dict[str, Any] = {}
    exec("\n".join(_init(fields) + _json(fields)), names, found)
    found["_json"] = staticmethod(found["_json"])
    return found


def _init(fields: list[_Field]) -> list[str]:
    lines = ["def __init__(self, *args, **kwds):"]
    if not fields:
        return lines + ["    if args or kwds:", "        Message.__init__(self, *args, **kwds)"]
    simple = len(fields) == 1 and fields[0].is_simple
    if simple:  # such as Float64, which is published for each joint
        lines += ["    if len(args) == 1 and not kwds and args[0] is not None:", "        %s" % fields[0].put("args[0]", "self")]
        lines += ["        return"]
    lines += ["    if args or kwds:", "        Message.__init__(self, *args, **kwds)"]
    for field in fields:
        lines += ["        if %s is None:" % field.get("self"), "            " + field.put(field.default(), "self")]
    lines += ["    else:"]
    lines += ["        " + field.put(field.default(), "self") for field in fields]
    return lines


def _json(fields: list[_Field]) -> list[str]:
    if not fields:
        return ["def _json(m):", "    return '{}'"]
    text = "{" + ",".join('"%s":%%s' % field.name for field in fields) + "}"
    return [
        "def _json(m):",
        "    try:",
        "        return %r %% (%s,)" % (text, ", ".join(field.written() for field in fields)),
        "    except (ValueError, TypeError, OverflowError, Unpackable) as error:",
        "        failed(m, error)",
    ]


def _reader(cls: Any, fields: list[_Field]) -> Any:
    names: dict[str, Any] = {
        "cls": cls, "new": cls.__new__, "R32": values.read_single, "R64": values.read_double, "RT": values.read_time,
        "RN": values.read_numbers, "misread": values.misread, "Unpackable": values.Unpackable,
    }  # fmt: skip
    names.update(("C%d" % field.at, field.cls) for field in fields if field.cls is not None)
    lines = ["def _of_json(d):", "    m = new(cls)"]
    if fields:
        lines += ["    try:"]
        lines += ["        " + field.put(field.read()) for field in fields]
        lines += ["    except (KeyError, TypeError, ValueError, OverflowError, Unpackable) as error:", "        misread(cls, error)"]
    lines += ["    return m"]
    found: dict[str, Any] = {}
    exec("\n".join(lines), names, found)
    return staticmethod(found["_of_json"])
