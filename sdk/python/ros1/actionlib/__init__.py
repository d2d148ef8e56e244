"""Actions: goals that a client gives a server, which tells how it gets on and how it ends.

A goal, its feedback and its result go over the ports of hrdsl (one for each client and server), and not over the five
topics that they take in ROS 1: a program that opens one of those is refused.
"""

import threading

import rospy
from actionlib.simple_action_client import SimpleActionClient, SimpleGoalState
from actionlib.action_client import (
    ActionClient,
    ClientGoalHandle,
    CommState,
    TerminalState,
    get_name_of_constant,
)
from actionlib.action_server import ActionServer, nop_cb
from actionlib.server_goal_handle import ServerGoalHandle
from actionlib.simple_action_server import SimpleActionServer
from actionlib.goal_id_generator import GoalIDGenerator
from actionlib.exceptions import ActionException
from actionlib_msgs.msg import GoalID, GoalStatus

__all__ = [
    "ActionClient",
    "ActionException",
    "ActionServer",
    "ClientGoalHandle",
    "CommState",
    "GoalID",
    "GoalIDGenerator",
    "GoalManager",
    "GoalStatus",
    "ServerGoalHandle",
    "SimpleActionClient",
    "SimpleActionServer",
    "SimpleGoalState",
    "TerminalState",
    "get_name_of_constant",
    "nop_cb",
    # What `from actionlib import *` has always brought along, and programs use.
    "rospy",
    "threading",
]


class GoalManager:
    """Refused."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        raise NotImplementedError(
            "actionlib.GoalManager, which an action client has inside, is not there in hrdsl: make an actionlib.ActionClient, whose send_goal"
            " returns a handle of the goal, or an actionlib.SimpleActionClient"
        )
