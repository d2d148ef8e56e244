"""The exceptions of rospy."""

from __future__ import annotations


class ROSException(Exception):
    """The base of what goes wrong for programs."""


class ROSSerializationException(ROSException):
    """A message cannot be sent as it is."""


class ROSInitException(ROSException):
    """The node is not there yet."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """A wait was interrupted, such as by the node's shutdown."""


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """Time moved backwards; in simulated time it never does."""

    def __init__(self, time: float) -> None:
        self.time = time  # by how many seconds
        super().__init__("ROS time moved backwards")


class ROSInternalException(Exception):
    """The base of what goes wrong within ROS."""


class TransportException(ROSInternalException):
    """Of connections."""


class TransportTerminated(TransportException):
    """A connection is gone."""


class TransportInitError(TransportException):
    """A connection could not be made."""


class ParameterInvalid(Exception):
    """An argument of the API of nodes."""
