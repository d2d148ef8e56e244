"""ROS 1's client library, over the exchange of hrdsl: what programs of ROS 1 import, in simulated time and without ROS."""

from rospy.client import (
    DEBUG,
    ERROR,
    FATAL,
    INFO,
    WARN,
    delete_param,
    get_master,
    get_param,
    get_param_cached,
    get_param_names,
    get_published_topics,
    has_param,
    init_node,
    myargv,
    on_shutdown,
    search_param,
    set_param,
    spin,
    wait_for_message,
)
from rospy.core import (
    get_node_uri,
    get_ros_root,
    is_shutdown,
    logdebug,
    logdebug_once,
    logdebug_throttle,
    logdebug_throttle_identical,
    logerr,
    logerr_once,
    logerr_throttle,
    logerr_throttle_identical,
    logfatal,
    logfatal_once,
    logfatal_throttle,
    logfatal_throttle_identical,
    loginfo,
    loginfo_once,
    loginfo_throttle,
    loginfo_throttle_identical,
    logout,
    logwarn,
    logwarn_once,
    logwarn_throttle,
    logwarn_throttle_identical,
    parse_rosrpc_uri,
    signal_shutdown,
)
from rospy.exceptions import (
    ROSException,
    ROSInitException,
    ROSInternalException,
    ROSInterruptException,
    ROSSerializationException,
    ROSTimeMovedBackwardsException,
    TransportException,
    TransportInitError,
    TransportTerminated,
)
from rospy.msg import AnyMsg
from rospy.msproxy import MasterProxy
from rospy.names import get_caller_id, get_name, get_namespace, remap_name, resolve_name
from rospy.rostime import Duration, Time, get_rostime, get_time
from rospy.service import Service, ServiceException, ServiceProxy, wait_for_service
from rospy.timer import Rate, Timer, sleep
from rospy.topics import Message, Publisher, SubscribeListener, Subscriber

__all__ = [
    "AnyMsg", "DEBUG", "Duration", "ERROR", "FATAL", "INFO", "MasterProxy", "Message", "Publisher", "ROSException",
    "ROSInitException", "ROSInternalException", "ROSInterruptException", "ROSSerializationException", "Rate", "Service",
    "ServiceException", "ServiceProxy", "SubscribeListener", "Subscriber", "Time", "TransportException", "TransportInitError",
    "TransportTerminated", "WARN", "delete_param", "get_caller_id", "get_master", "get_name", "get_namespace", "get_node_uri",
    "get_param", "get_param_cached", "get_param_names", "get_published_topics", "get_ros_root", "get_rostime", "get_time",
    "has_param", "init_node", "is_shutdown", "logdebug", "logdebug_once", "logdebug_throttle", "logerr", "logerr_once",
    "logerr_throttle", "logfatal", "logfatal_once", "logfatal_throttle", "loginfo", "loginfo_once", "loginfo_throttle", "logout",
    "logwarn", "logwarn_once", "logwarn_throttle", "myargv", "on_shutdown", "parse_rosrpc_uri", "remap_name", "resolve_name",
    "search_param", "set_param", "signal_shutdown", "sleep", "spin", "wait_for_message", "wait_for_service",
]  # fmt: skip


def __getattr__(name: str) -> object:
    if name == "Header":  # which few programs take from here
        from std_msgs.msg import Header

        return Header
    raise AttributeError("module 'rospy' has no attribute %r" % name)
