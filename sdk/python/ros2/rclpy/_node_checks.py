"""Whether a parameter's value fits its descriptor."""

from __future__ import annotations

from rclpy.parameter import Parameter

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

_TOLERANCE = 1e-6


def check_descriptor(parameter: Parameter, descriptor: Any, is_declared: bool, checks_read_only: bool) -> str:
    """Why it does not fit; "" if it does. The descriptor gets the parameter's name, and perhaps its type."""
    descriptor.name = parameter.name
    kind = parameter.type_
    if checks_read_only and descriptor.read_only:
        return "Trying to set a read-only parameter: %s." % parameter.name
    if descriptor.dynamic_typing:
        descriptor.type = kind.value
    elif is_declared and kind is Parameter.Type.NOT_SET:
        return "Static parameter cannot be undeclared"
    elif kind is not Parameter.Type.NOT_SET and kind.value != descriptor.type:
        wanted = Parameter.Type(descriptor.type)
        return "Wrong parameter type, expected '%s' got '%s'" % (wanted, kind)
    if kind is Parameter.Type.INTEGER and descriptor.integer_range:
        return _integer(parameter, descriptor.integer_range[0])
    if kind is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _double(parameter, descriptor.floating_point_range[0])
    return ""


def _integer(parameter: Parameter, limits: Any) -> str:
    value, name = parameter.value, parameter.name
    low, high = sorted((limits.from_value, limits.to_value))
    if value in (low, high):
        return ""
    if not low < value < high:
        return "Parameter %s out of range. Min: %s, Max: %s, value: %s" % (name, low, high, value)
    if limits.step != 0 and (value - low) % limits.step != 0:
        return _no_step(name, "a valid step", low, high, value, limits.step)
    return ""


def _double(parameter: Parameter, limits: Any) -> str:
    value, name = parameter.value, parameter.name
    low, high = sorted((limits.from_value, limits.to_value))
    if _is_close(value, low) or _is_close(value, high):
        return ""
    if not low < value < high:
        return "Parameter %s out of range Min: %s, Max: %s, value: %s" % (name, low, high, value)
    if limits.step != 0.0 and not _is_close(low + round((value - low) / limits.step) * limits.step, value):
        return _no_step(name, "close enough to a valid step", low, high, value, limits.step)
    return ""


def _no_step(name: str, what: str, low: Any, high: Any, value: Any, step: Any) -> str:
    text = "The parameter value for %s is not %s. Min: %s, max: %s, value: %s, step: %s"
    return text % (name, what, low, high, value, step)


def _is_close(one: float, other: float) -> bool:
    return one == other or abs(one - other) <= _TOLERANCE * max(abs(one), abs(other))
