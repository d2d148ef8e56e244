"""The classes of ROS 2's messages, services and actions, made from their definitions when they are first asked for.

They are laid out as rosidl lays them out for Python: slots with an underscore, properties that check what they are given,
a constructor that takes keywords.
"""

from __future__ import annotations

from types import FunctionType

from rosidl_codec import Codec
from rosidl_setters import blank_of, converter_of, prepared, setter_of, type_text

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    Resolve = Callable[[str], type]


class Message:
    """The base of all messages. Names of its own end with `_`, which those of fields do not."""

    __slots__ = ()

    _fields_and_field_types: dict[str, str] = {}
    _blanks_: tuple[tuple[Any, Any, bool], ...] = ()  # how to fill a slot, with what, and whether that has to be made
    _prepare_: dict[str, Callable[[Any], Any]] = {}  # what the constructor does with a field before it is set
    _numbers_: frozenset[str] = frozenset()  # slots whose values are printed without `array`

    def __init__(self, **kwargs: Any) -> None:
        for put, blank, is_made in self._blanks_:
            put(self, blank() if is_made else blank)
        if kwargs:
            self._fill_(kwargs)

    def _fill_(self, given: dict[str, Any]) -> None:
        names = self._fields_and_field_types
        given.pop("check_fields", None)  # of Jazzy; fields are always checked here
        wrong = sorted(name for name in given if name not in names)
        if wrong:
            raise AssertionError("Invalid arguments passed to constructor: %s" % ", ".join(wrong))
        for name in names:
            if name in given:
                value = given[name]
                if name in self._prepare_:
                    value = self._prepare_[name](value)
                setattr(self, name, value)

    def __repr__(self) -> str:
        texts = []
        for slot in self.__slots__:
            value = getattr(self, slot)
            text = repr(value)
            if slot in self._numbers_:
                text = text[len("array('d', ") : -1] if len(value) else "[]"
            texts.append("%s=%s" % (slot[1:], text))
        cls = type(self)
        return "%s.%s(%s)" % (cls.__module__.rpartition(".")[0], cls.__name__, ", ".join(texts))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        for slot in self.__slots__:
            same = getattr(self, slot) == getattr(other, slot)
            if not (same if isinstance(same, bool) else same.all()):
                return False
        return True

    __hash__ = None  # type: ignore[assignment]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """The fields' names, and their types as texts."""
        return dict(cls._fields_and_field_types)


class _OfMessages(type):
    """Says of an attribute that is missing on purpose what to use instead."""

    def __getattr__(cls, name: str) -> Any:
        if name == "SLOT_TYPES":
            raise AttributeError("SLOT_TYPES of %s: use get_fields_and_field_types() instead" % cls.__name__)
        raise AttributeError("type object %r has no attribute %r" % (cls.__name__, name))


def make_class(definition: dict[str, Any], resolve: Resolve) -> type:
    """The class of a message; `resolve` finds the classes of the messages in it by their names."""
    fields = definition["fields"]
    package, space, name = definition["name"].split("/")
    constants = {each["name"]: _constant(each) for each in definition["constants"]}
    namespace: dict[str, Any] = {
        "__slots__": ["_" + field["name"] for field in fields],
        "__module__": "%s.%s.%s" % (package, space, _module_name(name)),
        "__doc__": "Message class %r." % name,
        "_fields_and_field_types": {field["name"]: type_text(field) for field in fields},
        "_numbers_": frozenset("_" + field["name"] for field in fields if prepared(field) == "array"),
        "_codec_": Codec(definition, resolve),
        "_definition_": definition,
        **constants,
    }
    for field in fields:
        if "default" in field:
            namespace[field["name"].upper() + "__DEFAULT"] = blank_of(field, resolve)[2]
    namespace["__init__"] = _init_of(name)
    cls: Any = _OfMessages(name, (Message,), namespace)
    blanks = []
    for field in fields:
        slot = cls.__dict__["_" + field["name"]]
        put = slot.__set__
        setattr(cls, field["name"], property(slot.__get__, setter_of(field, put, resolve), None, _doc(field)))
        blank, is_made, _ = blank_of(field, resolve)
        blanks.append((put, blank, is_made))
    cls._blanks_ = tuple(blanks)
    cls._prepare_ = {each["name"]: converter_of(each) for each in fields if prepared(each) is not None}
    return cls  # type: ignore[no-any-return]


def make_service(definition: dict[str, Any], resolve: Resolve) -> type:
    """The class of a service, which holds those of its request and response."""
    return _holder(definition, "Service", {
        "Request": resolve(definition["request"]),
        "Response": resolve(definition["response"]),
    })  # fmt: skip


def make_action(definition: dict[str, Any], resolve: Resolve) -> type:
    """The class of an action, which holds those of its goal, result and feedback."""
    return _holder(definition, "Action", {
        "Goal": resolve(definition["goal"]),
        "Result": resolve(definition["result"]),
        "Feedback": resolve(definition["feedback"]),
    })  # fmt: skip


def _holder(definition: dict[str, Any], kind: str, held: dict[str, Any]) -> type:
    def refuse(self: object) -> None:
        raise NotImplementedError("%s classes can not be instantiated" % kind)

    package, space, name = definition["name"].split("/")
    module = "%s.%s.%s" % (package, space, _module_name(name))
    return type(name, (), {"__init__": refuse, "__module__": module, "_definition_": definition, "_kind_": kind, **held})


def _init_of(name: str) -> FunctionType:
    """The constructor, under the name that errors are to tell."""
    made = FunctionType(Message.__init__.__code__, globals(), "__init__")
    made.__qualname__ = name + ".__init__"
    return made


def _constant(constant: dict[str, Any]) -> Any:
    kind, value = constant["type"], constant["value"]
    if kind in ("float32", "float64"):
        return float(value)
    return bytes([value]) if kind == "byte" else value


def _doc(field: dict[str, Any]) -> str:
    return "Message field %r." % field["name"]


def _module_name(name: str) -> str:
    """The file that rosidl would write the class to: `_laser_scan` for `LaserScan`, and for parts of services
    that of the service."""
    if not name.endswith("_FeedbackMessage"):
        name = name.partition("_")[0]
    text = ""
    for place, letter in enumerate(name):
        before, after = name[place - 1 : place], name[place + 1 : place + 2]
        if letter.isupper() and before and before != "_" and (not before.isupper() or after.islower()):
            text += "_"
        text += letter.lower()
    return "_" + text
