"""State machines of states in Python code, with the interface and the behaviour of ROS 1's smach.

Run by hrdsl, each machine tells what it declares and how it moves (`smach._told`); everything else works without.
"""

from smach._told import is_the_end
from smach.log import logdebug, logerr, loginfo, logwarn, set_loggers
from smach.exceptions import (
    InvalidConstructionError,
    InvalidStateError,
    InvalidTransitionError,
    InvalidUserCodeError,
    SmachError,
)
from smach.util import CBInterface, cb_interface, has_smach_interface, is_shutdown, set_shutdown_check
from smach.state import CBState, State
from smach.user_data import Const, Remapper, UserData, get_const
from smach.container import Container
from smach.state_machine import StateMachine
from smach.sequence import Sequence
from smach.concurrence import Concurrence
from smach.iterator import Iterator
from smach import concurrence, container, exceptions, iterator, log, sequence, state, state_machine, user_data, util

__all__ = [
    "CBInterface",
    "CBState",
    "Concurrence",
    "Const",
    "Container",
    "InvalidConstructionError",
    "InvalidStateError",
    "InvalidTransitionError",
    "InvalidUserCodeError",
    "Iterator",
    "Remapper",
    "Sequence",
    "SmachError",
    "State",
    "StateMachine",
    "UserData",
    "cb_interface",
    "concurrence",
    "container",
    "exceptions",
    "get_const",
    "has_smach_interface",
    "is_shutdown",
    "is_the_end",
    "iterator",
    "log",
    "logdebug",
    "logerr",
    "loginfo",
    "logwarn",
    "sequence",
    "set_loggers",
    "set_shutdown_check",
    "state",
    "state_machine",
    "user_data",
    "util",
]
