"""What clients and servers of actions have in common: identifiers, states, and the messages that rosidl makes."""

from __future__ import annotations

import os

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)
NAMES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")

#: How the protocol calls the ends.
ENDS = {SUCCEEDED: "succeeded", CANCELED: "canceled", ABORTED: "aborted"}
STATES = {name: state for state, name in ENDS.items()}


def new_id() -> bytes:
    """An identifier of a goal, by the test's seed: a random UUID."""
    made = bytearray(os.urandom(16))
    made[6] = made[6] & 0x0F | 0x40
    made[8] = made[8] & 0x3F | 0x80
    return bytes(made)


def uuid_message(number: bytes) -> Any:
    """The identifier as a message."""
    from unique_identifier_msgs.msg import UUID

    return UUID(uuid=list(number))


class Told:
    """A response or feedback, as the messages that rosidl makes for an action have it."""

    def __init__(self, name: str, **fields: Any) -> None:
        self._name = name
        self.__dict__.update(fields)

    def __repr__(self) -> str:
        fields = ["%s=%r" % field for field in self.__dict__.items() if field[0] != "_name"]
        return "%s(%s)" % (self._name, ", ".join(fields))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Told) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]


def title(action_type: Any, part: str) -> str:
    """The name of a message that rosidl makes for an action."""
    return "%s.%s_%s" % (action_type.__module__.rpartition(".")[0], action_type.__name__, part)
