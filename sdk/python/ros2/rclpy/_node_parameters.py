"""The part of nodes that is about parameters."""

from __future__ import annotations

from rclpy._interfaces import ParameterDescriptor, SetParametersResult
from rclpy._node_checks import check_descriptor
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.validate_parameter_name import validate_parameter_name

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable


class NodeParameters:
    """Parameters, declared and set."""

    _parameters: dict[str, Parameter]
    _descriptors: dict[str, Any]
    _parameter_overrides: dict[str, Parameter]
    _allow_undeclared_parameters: bool
    _pre_set_parameters_callbacks: list[Any]
    _on_set_parameters_callbacks: list[Any]
    _post_set_parameters_callbacks: list[Any]

    def _init_parameters_(self, overrides: dict[str, Any], allow_undeclared: bool) -> None:
        self._parameters = {}
        self._descriptors = {}
        self._parameter_overrides = {name: Parameter(name, value=value) for name, value in overrides.items()}
        self._allow_undeclared_parameters = allow_undeclared
        self._pre_set_parameters_callbacks = []
        self._on_set_parameters_callbacks = []
        self._post_set_parameters_callbacks = []

    # ── declaring ──

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declares one: with a value, a `Parameter.Type`, or a descriptor that lets its type change."""
        if value is None and descriptor is None:
            given: tuple[Any, ...] = (name,)
        else:
            given = (name, value, ParameterDescriptor() if descriptor is None else descriptor)
        return self.declare_parameters("", [given], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Iterable[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declares several: each is a name, perhaps a value or a type, and perhaps a descriptor. Overrides from the command
        line and from files come before values."""
        declared, descriptors = [], {}
        for index, given in enumerate(parameters):
            parameter, descriptor = self._declaration_(namespace, index, given, ignore_override)
            declared.append(parameter)
            descriptors[parameter.name] = descriptor
        known = [parameter.name for parameter in declared if parameter.name in self._parameters]
        if known:
            raise ParameterAlreadyDeclaredException(known)
        for parameter in declared:
            self._declare_(parameter, descriptors)
        return [self._parameters[parameter.name] for parameter in declared]

    def _declaration_(
        self, namespace: str, index: int, given: tuple[Any, ...], ignore_override: bool
    ) -> tuple[Parameter, Any]:
        if not 1 <= len(given) <= 3:
            raise TypeError(
                "Invalid parameter tuple length at index %d in parameters list: %s; expecting length between 1 and 3"
                % (index, given)
            )
        name = given[0]
        if not isinstance(name, str):
            raise TypeError("First element %s at index %d in parameters list is not a str." % (name, index))
        name = "%s.%s" % (namespace, name) if namespace else name
        validate_parameter_name(name)
        descriptor: Any = given[2] if len(given) == 3 else ParameterDescriptor()
        if not isinstance(descriptor, ParameterDescriptor):
            raise TypeError(
                "Third element %s at index %d in parameters list is not a ParameterDescriptor." % (descriptor, index)
            )
        if len(given) == 1:
            _warn_of_bare_name(name)
            descriptor.dynamic_typing = True
        value = _initial(name, given[1] if len(given) > 1 else None, descriptor)
        if not ignore_override and name in self._parameter_overrides:
            value = self._parameter_overrides[name].value
        return Parameter(name, value=value), descriptor

    def _declare_(self, parameter: Parameter, descriptors: dict[str, Any]) -> None:
        result = self._set_at_once_([parameter], descriptors, keeps_unset=True)
        if result.successful:
            return
        if result.reason.startswith("Wrong parameter type"):
            wanted = Parameter.Type(descriptors[parameter.name].type).name
            raise InvalidParameterTypeException(parameter, wanted)
        raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)

    def undeclare_parameter(self, name: str) -> None:
        """Takes it back."""
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name], self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        """Whether it is declared."""
        return name in self._parameters

    # ── getting ──

    def get_parameter(self, name: str) -> Parameter:
        """The parameter of this name."""
        found = self._parameters.get(name)
        if found is None:
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return Parameter(name, Parameter.Type.NOT_SET, None)
        if found.type_ is Parameter.Type.NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return found

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """The parameters of these names."""
        _check_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """The parameter, or the alternative if it is not set."""
        found = self._parameters.get(name)
        if found is not None and found.type_ is not Parameter.Type.NOT_SET:
            return found
        return Parameter(name, Parameter.Type.NOT_SET) if alternative_value is None else alternative_value

    def get_parameter_type(self, name: str) -> Any:
        """Its type, as a number."""
        if name in self._parameters:
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return Parameter.Type.NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Their types, as numbers."""
        _check_names(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Those whose names begin so, by the rest of their names."""
        prefix = prefix + PARAMETER_SEPARATOR_STRING if prefix else ""
        return {name[len(prefix) :]: each for name, each in self._parameters.items() if name.startswith(prefix)}

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        """The names below these prefixes, so many levels deep; 0 for all."""
        from rcl_interfaces.msg import ListParametersResult

        result: Any = ListParametersResult()
        for name in self._parameters:
            if _is_listed(name, prefixes, depth):
                result.names.append(name)
                above = name.rpartition(PARAMETER_SEPARATOR_STRING)[0]
                if above and above not in result.prefixes:
                    result.prefixes.append(above)
        return result

    # ── setting ──

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Sets them one by one; the results say for each whether it was set, and why not."""
        results = []
        for parameter in parameter_list:
            self._check_declared_([parameter])
            results.append(self._set_changed_([parameter]))
        return results

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Sets all of them, or none."""
        self._check_declared_(parameter_list)
        return self._set_changed_(parameter_list)

    def _check_declared_(self, parameters: list[Parameter]) -> None:
        if not all(isinstance(parameter, Parameter) for parameter in parameters):
            raise TypeError("parameter must be instance of type '%r'" % Parameter)
        unknown = [parameter.name for parameter in parameters if parameter.name not in self._parameters]
        if unknown and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(unknown)

    def _set_changed_(self, parameters: list[Parameter]) -> Any:
        if self._pre_set_parameters_callbacks:
            changed: list[Parameter] = []
            for callback in self._pre_set_parameters_callbacks:
                changed.extend(callback(parameters))
            if not changed:
                reason = (
                    "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying the "
                    "original parameters list."
                )
                return SetParametersResult(successful=False, reason=reason)
            self._check_declared_(changed)
            parameters = changed
        return self._set_at_once_(parameters)

    def _set_at_once_(
        self, parameters: list[Parameter], descriptors: dict[str, Any] | None = None, keeps_unset: bool = False
    ) -> Any:
        known = self._descriptors if descriptors is None else descriptors
        for parameter in parameters:
            if parameter.name in known:
                reason = check_descriptor(parameter, known[parameter.name], parameter.name in self._parameters, descriptors is None)
                if reason:
                    return SetParametersResult(successful=False, reason=reason)
        for callback in self._on_set_parameters_callbacks:
            result = callback(parameters)
            if not result.successful:
                return result
        news: list[Parameter] = []
        changes: list[Parameter] = []
        gone: list[Parameter] = []
        for parameter in parameters:
            if parameter.type_ is Parameter.Type.NOT_SET and not keeps_unset:
                gone.append(parameter)
                self._parameters.pop(parameter.name, None)
                self._descriptors.pop(parameter.name, None)
                continue
            if descriptors is not None:
                self._descriptors[parameter.name] = descriptors[parameter.name]
            elif parameter.name not in self._descriptors:
                self._descriptors[parameter.name] = ParameterDescriptor(dynamic_typing=True)
            is_new = self.get_parameter_or(parameter.name).type_ is Parameter.Type.NOT_SET
            (news if is_new else changes).append(parameter)
            self._parameters[parameter.name] = parameter
        self._tell_of_parameters_(news, changes, gone)
        for callback in self._post_set_parameters_callbacks:
            callback(parameters)
        return SetParametersResult(successful=True)

    def _tell_of_parameters_(self, news: list[Parameter], changes: list[Parameter], gone: list[Parameter]) -> None:
        raise NotImplementedError

    # ── callbacks ──

    def add_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        """Calls it before parameters are checked; it returns those that are to be set."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], Any]) -> None:
        """Calls it before parameters are set; its `SetParametersResult` says whether they may be."""
        self._on_set_parameters_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        """Calls it after parameters were set."""
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Any) -> None:
        """Calls it no more."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: Any) -> None:
        """Calls it no more."""
        self._on_set_parameters_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: Any) -> None:
        """Calls it no more."""
        self._post_set_parameters_callbacks.remove(callback)

    # ── descriptors ──

    def describe_parameter(self, name: str) -> Any:
        """Its descriptor."""
        if name in self._descriptors:
            return self._descriptors[name]
        if self._allow_undeclared_parameters:
            return ParameterDescriptor()
        raise ParameterNotDeclaredException(name)

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Their descriptors."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Gives it another descriptor, and, where its value does not fit that, another value."""
        if name not in self._parameters:
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return self.get_parameter(name).get_parameter_value()
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        parameter = self.get_parameter(name)
        if check_descriptor(parameter, descriptor, True, False):
            if alternative_value is not None:
                from rcl_interfaces.msg import Parameter as Made

                parameter = Parameter.from_parameter_msg(Made(name=name, value=alternative_value))
            reason = check_descriptor(parameter, descriptor, True, False)
            if reason:
                raise InvalidParameterValueException(name, parameter.value, reason)
        self._parameters[name] = parameter
        self._descriptors[name] = descriptor
        return parameter.get_parameter_value()


def _check_names(names: Iterable[Any]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")


def _warn_of_bare_name(name: str) -> None:
    import warnings

    warnings.warn(
        "when declaring parameter named '%s', declaring a parameter only providing its name is deprecated. "
        "You have to either:\n"
        '\t- Pass a name and a default value different to "PARAMETER NOT SET" (and optionally a descriptor).\n'
        "\t- Pass a name and a parameter type.\n"
        "\t- Pass a name and a descriptor with `dynamic_typing=True" % name,
        stacklevel=5,
    )


def _initial(name: str, given: Any, descriptor: Any) -> Any:
    """The value that is declared; what its type is goes to the descriptor."""
    if isinstance(given, Parameter.Type):
        if given is Parameter.Type.NOT_SET:
            raise ValueError("Cannot declare parameter {%s} as statically typed of type NOT_SET" % name)
        if descriptor.dynamic_typing:
            raise ValueError(
                "When declaring parameter {%s} passing a descriptor with`dynamic_typing=True` is not allowed when the "
                "parameter type is provided" % name
            )
        descriptor.type = given.value
        return None
    if type(given).__name__ == "ParameterValue" and hasattr(given, "bool_array_value"):
        from rclpy.parameter import parameter_value_to_python

        given = parameter_value_to_python(given)
    if not descriptor.dynamic_typing:
        descriptor.type = Parameter.Type.from_parameter_value(given).value
        if given is None:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
    return given


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    def fits(rest: str) -> bool:
        return depth == 0 or rest.count(PARAMETER_SEPARATOR_STRING) < depth

    if not prefixes:
        return fits(name)
    for prefix in prefixes:
        below = prefix + PARAMETER_SEPARATOR_STRING
        if name == prefix or (name.startswith(below) and fits(name[len(below) :])):
            return True
    return False
