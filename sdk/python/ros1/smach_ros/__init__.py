"""States for ROS 1, with the interface of smach_ros. Messages of smach go to the node's log.

What needs actions or services is imported when it is first asked for.
"""

from __future__ import annotations

import rospy
import smach

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

smach.set_loggers(rospy.loginfo, rospy.logwarn, rospy.logdebug, rospy.logerr)
smach.set_shutdown_check(rospy.is_shutdown)

_PLACES = {
    "set_preempt_handler": "util",
    "ActionServerWrapper": "action_server_wrapper",
    "IntrospectionClient": "introspection",
    "IntrospectionServer": "introspection",
    "SimpleActionState": "simple_action_state",
    "ServiceState": "service_state",
    "MonitorState": "monitor_state",
    "ConditionState": "condition_state",
}

__all__ = list(_PLACES)


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError("module 'smach_ros' has no attribute %r" % name)
    from importlib import import_module

    found = getattr(import_module("smach_ros." + _PLACES[name]), name)
    globals()[name] = found
    return found
