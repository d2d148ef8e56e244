"""Where smach's messages go: to standard output, until `set_loggers` (which `smach_ros` calls) says otherwise.

The rest of the package calls `smach.loginfo` and not this module's, since the former can be replaced.
"""

from __future__ import annotations

import smach

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

__all__ = ["set_loggers", "loginfo", "logwarn", "logerr", "logdebug"]


def loginfo(msg: object) -> None:
    """Something that happens."""
    print("[  INFO ] : %s" % (msg,))


def logwarn(msg: object) -> None:
    """Something that is suspicious."""
    print("[  WARN ] : %s" % (msg,))


def logdebug(msg: object) -> None:
    """Something for who looks for a fault."""
    print("[ DEBUG ] : %s" % (msg,))


def logerr(msg: object) -> None:
    """A fault."""
    print("[ ERROR ] : %s" % (msg,))


def set_loggers(
    info: Callable[[str], Any], warn: Callable[[str], Any], debug: Callable[[str], Any], error: Callable[[str], Any]
) -> None:
    """Replaces the functions that get the messages."""
    place: Any = smach
    place.loginfo, place.logwarn, place.logdebug, place.logerr = info, warn, debug, error
