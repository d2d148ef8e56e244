"""Whether what a program gives as a type is one."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


def definition_of(cls: Any) -> dict[str, Any]:
    """The definition of a class that was made from one; raises AttributeError for any other."""
    found = getattr(cls, "__dict__", {}).get("_definition_")
    if found is None:
        raise AttributeError(
            "type object '%s' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type but it should be a "
            "ROS 2 message type. Make sure to source your ROS 2 workspace after your ROS 1 workspace."
            % getattr(cls, "__name__", cls)
        )
    return found  # type: ignore[no-any-return]


def name_of(cls: Any, kind: str) -> str:
    """The full name of a type, which has to be a `Message`, a `Service` or an `Action`."""
    definition = definition_of(cls)
    if getattr(cls, "_kind_", "Message") != kind:
        what, others = {
            "Message": ("message", "a service or action"),
            "Service": ("service", "a message or action"),
            "Action": ("action", "a message or service"),
        }[kind]
        raise RuntimeError("The %s type provided is not valid (%s), this might be %s" % (what, cls, others))
    return str(definition["name"])


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Raises AttributeError for what is no type."""
    definition_of(msg_or_srv_type)


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Raises RuntimeError for what is no message."""
    name_of(msg_type, "Message")


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Raises RuntimeError for what is no service."""
    name_of(srv_type, "Service")


def decoded(codec: Any, value: Any, what: str) -> Any:
    """The message of what has arrived; raises ProtocolError, which names `what`, if it does not fit."""
    try:
        return codec.decode(value)
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
        from hrdsl.errors import ProtocolError

        raise ProtocolError("%s: what has arrived does not fit its type: %r" % (what, error)) from None
