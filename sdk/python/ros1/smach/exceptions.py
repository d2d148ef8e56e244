"""What is wrong with a machine; each tells the log when it is made, whether or not somebody catches it."""

from __future__ import annotations

import smach

__all__ = [
    "SmachError",
    "InvalidTransitionError",
    "InvalidStateError",
    "InvalidConstructionError",
    "InvalidUserCodeError",
]


class SmachError(Exception):
    """Base of the others."""

    def __init__(self, message: str) -> None:
        smach.logerr("%s: %s" % (type(self).__name__, message))
        super().__init__(message)


class InvalidTransitionError(SmachError):
    """An outcome that leads nowhere."""


class InvalidStateError(SmachError):
    """A state, or a container, that is declared or used wrongly."""


class InvalidConstructionError(SmachError):
    """Something is added to a container that is not open."""


class InvalidUserCodeError(SmachError):
    """Code of the program, called by smach, has failed; the message has its traceback."""
