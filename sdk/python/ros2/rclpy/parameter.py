"""Parameters: a name, a type, a value."""

from __future__ import annotations

from array import array
from enum import Enum

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

PARAMETER_SEPARATOR_STRING = "."

#: The member of `rcl_interfaces.msg.ParameterValue` that has the value, by the number of its type.
_MEMBERS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}


class _Type(Enum):
    """The types of parameters, numbered as in `rcl_interfaces.msg.ParameterType`."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9

    def __str__(self) -> str:
        return "Type.%s" % self.name

    @classmethod
    def from_parameter_value(cls, parameter_value: Any) -> _Type:
        """The type of a value; raises TypeError if no parameter has such a value."""
        for kind, name in ((bool, "BOOL"), (int, "INTEGER"), (float, "DOUBLE"), (str, "STRING")):
            if isinstance(parameter_value, kind):
                return cls[name]
        if parameter_value is None:
            return cls.NOT_SET
        if not isinstance(parameter_value, (list, tuple, array)):
            raise TypeError("The given value is not one of the allowed types '%s'." % (parameter_value,))
        for element, name in _ELEMENTS:
            if all(isinstance(value, element) for value in parameter_value):
                return cls[name]
        raise TypeError("The given value is not a list of one of the allowed types '%s'." % (parameter_value,))

    def check(self, parameter_value: Any) -> bool:
        """Whether a value is of this type."""
        if self is _Type.NOT_SET:
            return parameter_value is None
        single = {"BOOL": bool, "INTEGER": int, "DOUBLE": float, "STRING": str}.get(self.name)
        if single is not None:
            return isinstance(parameter_value, single)
        element = {name: kind for kind, name in _ELEMENTS}[self.name]
        kinds = (list, tuple, array) if element in (int, float) else (list, tuple)
        if not isinstance(parameter_value, kinds):
            return False
        if element is bytes and any(len(value) != 1 for value in parameter_value):
            return False
        return all(isinstance(value, element) for value in parameter_value)


#: What lists may hold, in the order in which it is tried.
_ELEMENTS: tuple[tuple[type, str], ...] = (
    (bytes, "BYTE_ARRAY"),
    (bool, "BOOL_ARRAY"),
    (int, "INTEGER_ARRAY"),
    (float, "DOUBLE_ARRAY"),
    (str, "STRING_ARRAY"),
)
_Type.__name__, _Type.__qualname__ = "Type", "Parameter.Type"


class Parameter:
    """A parameter."""

    Type = _Type

    def __init__(self, name: str, type_: _Type | None = None, value: Any = None) -> None:
        if type_ is None:
            type_ = _Type.from_parameter_value(value)
        if not isinstance(type_, _Type):
            raise TypeError("type must be an instance of '%r'" % _Type)
        if not type_.check(value):
            raise ValueError("Type '%s' and value '%s' do not agree" % (type_, value))
        self._type_ = type_
        self._name = name
        self._value = value

    @property
    def name(self) -> str:
        """Its name."""
        return self._name

    @property
    def type_(self) -> _Type:
        """Its type."""
        return self._type_

    @property
    def value(self) -> Any:
        """Its value."""
        return self._value

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """As a message tells it."""
        value = param_msg.value
        member = _MEMBERS.get(value.type)
        return cls(param_msg.name, _Type(value.type), None if member is None else getattr(value, member))

    def get_parameter_value(self) -> Any:
        """The value as a message."""
        from rcl_interfaces.msg import ParameterValue

        message: Any = ParameterValue(type=self._type_.value)
        if self._type_ is not _Type.NOT_SET:
            setattr(message, _MEMBERS[self._type_.value], self._value)
        return message

    def to_parameter_msg(self) -> Any:
        """The parameter as a message."""
        from rcl_interfaces.msg import Parameter as Made

        return Made(name=self._name, value=self.get_parameter_value())


def parameter_value_to_python(parameter_value: Any) -> Any:
    """The value that a message holds."""
    kind = parameter_value.type
    if kind == 0:
        return None
    if kind not in _MEMBERS:
        raise RuntimeError("unexpected parameter type %s" % kind)
    value = getattr(parameter_value, _MEMBERS[kind])
    return value if kind < 5 else list(value)


def get_parameter_value(string_value: str) -> Any:
    """The message of a value that is written as in a file of parameters."""
    from rclpy._yaml import parse_value

    return Parameter("", value=parse_value(string_value)).get_parameter_value()


def parameter_dict_from_yaml_file(
    parameter_file: str, use_wildcard: bool = False, target_nodes: list[str] | None = None, namespace: str = ""
) -> dict[str, Any]:
    """The parameters in a file, as messages by their names: those of these nodes, or of all; with the wildcard, those below
    `/**`, too. Raises RuntimeError if there are none."""
    from rclpy._yaml import parse

    with open(parameter_file, encoding="utf-8") as file:
        document = parse(file.read()) or {}
    if not isinstance(document, dict):
        raise RuntimeError("%s: there are no names of nodes" % parameter_file)
    keys = ["/**"] if use_wildcard and "/**" in document else []
    for node in target_nodes or ():
        key = next((key for key in document if key.lstrip("/") == node.lstrip("/")), None)
        if key is None:
            told = "Param file does not contain parameters for %s,only for nodes: %s " % (node, list(document))
            raise RuntimeError(told)
        keys.append(key)
    if not target_nodes:
        keys += [key for key in document if key != "/**"]
    if not keys:
        raise RuntimeError("Param file does not contain selected parameters")
    found: dict[str, Any] = {}
    for key in keys:
        below = document[key]
        if not isinstance(below, dict) or not isinstance(below.get("ros__parameters"), dict):
            raise RuntimeError("YAML file is not a valid ROS parameter file for node %s" % key)
        _unpack(namespace, below["ros__parameters"], found)
    return found


def _unpack(prefix: str, values: dict[str, Any], found: dict[str, Any]) -> None:
    for name, value in values.items():
        full = "%s%s%s" % (prefix, PARAMETER_SEPARATOR_STRING if prefix else "", name)
        if isinstance(value, dict):
            _unpack(full, value, found)
        else:
            found[full] = Parameter(full, value=value).to_parameter_msg()
