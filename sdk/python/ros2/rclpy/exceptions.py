"""The exceptions of rclpy, with its words."""

from __future__ import annotations

from rclpy._rclpy_pybind11 import InvalidHandle as InvalidHandle

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class NotInitializedException(Exception):
    """Something needs `rclpy.init()` first."""

    def __init__(self, *args: Any) -> None:
        super().__init__("rclpy.init() has not been called", *args)


class NoTypeSupportImportedException(Exception):
    """A type that is none of a message package."""

    def __init__(self, *args: Any) -> None:
        super().__init__("no type_support imported")


class NameValidationException(Exception):
    """A name is invalid; the message points at the place."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("Invalid %s: %s:\n  '%s'\n   %s^" % (name_type, error_msg, name, " " * invalid_index))


class InvalidNamespaceException(NameValidationException):
    """A namespace is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """The name of a node is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """The name of a topic is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """The name of a service is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class ParameterException(Exception):
    """The base of those about parameters."""

    def __init__(self, error_msg: str, parameters: Any, *args: Any) -> None:
        super().__init__("%s: %s" % (error_msg, parameters))


class ParameterNotDeclaredException(ParameterException):
    """A parameter has to be declared first."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        Exception.__init__(self, "Invalid access to undeclared parameter(s)", parameters, *args)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter is declared a second time."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        Exception.__init__(self, "Parameter(s) already declared", parameters, *args)


class InvalidParameterException(ParameterException):
    """A parameter's name is invalid."""

    def __init__(self, parameter: Any, *args: Any) -> None:
        Exception.__init__(self, "Invalid parameter name", parameter, *args)


class InvalidParameterTypeException(ParameterException):
    """A parameter gets a value of another type than declared."""

    def __init__(self, desired_parameter: Any, expected_type: Any, *args: Any) -> None:
        kind = desired_parameter.type_
        Exception.__init__(
            self,
            "Trying to set parameter '%s' to '%s' of type '%s', expecting type '%s'"
            % (desired_parameter.name, desired_parameter.value, kind.name, expected_type),
            *args,
        )
        self._actual_type = kind
        self._param_name = desired_parameter.name


class InvalidParameterValueException(ParameterException):
    """A parameter's value is refused, by a callback or a descriptor."""

    def __init__(self, parameter: Any, value: Any, reason: Any, *args: Any) -> None:
        text = "Invalid parameter value (%s) for parameter. Reason: %s" % (value, reason)
        Exception.__init__(self, text, parameter, *args)


class ParameterImmutableException(ParameterException):
    """A parameter that can only be read is written."""

    def __init__(self, parameter: Any, *args: Any) -> None:
        Exception.__init__(self, "Attempted to modify read-only parameter", parameter, *args)


class ParameterUninitializedException(ParameterException):
    """A parameter is read that has no value yet."""

    def __init__(self, parameter_name: str, *args: Any) -> None:
        Exception.__init__(self, "The parameter '%s' is not initialized" % parameter_name, *args)


class ROSInterruptException(Exception):
    """`rclpy.shutdown()` has ended a wait."""

    def __init__(self, *args: Any) -> None:
        super().__init__("rclpy.shutdown() has been called", *args)
