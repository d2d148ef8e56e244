"""Actions as the protocol has them: their types, their messages in JSON, and which servers there are."""

from __future__ import annotations

import genpy
import rospy
from actionlib.exceptions import ActionException
from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Spec:
    """The classes of an action, found in its message `FooAction`."""

    def __init__(self, action: Any) -> None:
        try:
            whole = action()
            self.action_goal = type(whole.action_goal)
            self.action_result = type(whole.action_result)
            self.action_feedback = type(whole.action_feedback)
            self.goal = type(whole.action_goal.goal)
            self.result = type(whole.action_result.result)
            self.feedback = type(whole.action_feedback.feedback)
            kind: str = action._type
        except (AttributeError, TypeError):
            raise ActionException("Type is not an action spec: %s" % (action,)) from None
        self.type = kind[: -len("Action")] if kind.endswith("Action") else kind


def encode(message: Any, expected: Any, name: str) -> bytes:
    """A message in JSON; `name` is the action's, for who reads that it does not fit."""
    if not isinstance(message, expected):
        raise rospy.ROSSerializationException("action %s takes a %s, not a %s" % (name, expected._type, type(message).__name__))
    try:
        text: str = expected._json(message)
    except genpy.SerializationError as error:
        raise rospy.ROSSerializationException("action %s: %s" % (name, error)) from None
    return text.encode("ascii")


def decode(value: Any, expected: Any) -> Any:
    """A message from JSON; an empty one from null, by which a harness says nothing more about an end."""
    return expected() if value is None else expected._of_json(value)


class Servers:
    """Which actions have a server, as far as this program knows."""

    def __init__(self) -> None:
        self._names: set[str] | None = None  # None: to be asked for
        self._waiting: list[Any] = []
        the_exchange().on_change(self._changed)
        rospy.core.add_shutdown_hook(lambda reason: self._changed())

    def has(self, name: str) -> bool:
        """Whether there is a server of this name now."""
        if self._names is None:
            self._names = {port["name"] for port in the_exchange().listing() if port["kind"] == "action_server"}
        return name in self._names

    def wait(self, name: str, type_name: str, timeout: Any) -> bool:
        """Waits until there is one, at most for a duration; zero is for ever."""
        deadline = rospy.get_rostime() + timeout
        if not self.has(name):
            give_up = the_exchange().time + timeout.to_nsec() if timeout != rospy.Duration(0.0) else None
            the_exchange().awaits("action_client", name, type_name, give_up)
        while not rospy.is_shutdown():
            if self.has(name):
                return True
            left = None
            if timeout != rospy.Duration(0.0):
                left = (deadline - rospy.get_rostime()).to_nsec()
                if left <= 0:
                    break
            self._wait_for_change(left)
        return False

    def _wait_for_change(self, nanoseconds: int | None) -> None:
        mailbox = Mailbox()
        self._waiting.append(mailbox)
        try:
            mailbox.get(nanoseconds)
        finally:
            self._waiting.remove(mailbox)

    def _changed(self) -> None:
        self._names = None
        for mailbox in self._waiting:
            mailbox.put(True)


_servers: Servers | None = None


def the_servers() -> Servers:
    """Those that this program knows of."""
    global _servers
    if _servers is None:
        _servers = Servers()
    return _servers
