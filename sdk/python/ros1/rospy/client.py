"""The beginning of a node, and what else a program asks of it."""

from __future__ import annotations

import os
import sys

import genpy
import rosgraph.names
from hrdsl.errors import ProtocolError
from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox
from rospy import core, log, names, rostime
from rospy.core import signal_shutdown
from rospy.exceptions import ROSException, ROSInitException, ROSInterruptException
from rospy.graph import graph
from rospy.log import logdebug, logerr
from rospy.params import (
    delete_param,
    get_param,
    get_param_cached,
    get_param_names,
    has_param,
    search_param,
    set_param,
)
from rospy.subscribers import Listener, Unreadable

__all__ = [
    "DEBUG", "ERROR", "FATAL", "INFO", "WARN", "delete_param", "get_master", "get_param", "get_param_cached", "get_param_names",
    "get_published_topics", "has_param", "init_node", "myargv", "on_shutdown", "search_param", "set_param", "spin",
    "wait_for_message",
]  # fmt: skip

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16

_init_node_args: tuple[Any, ...] | None = None


def myargv(argv: list[str] | None = None) -> list[str]:
    """The arguments without those that are for ROS."""
    return [arg for arg in (sys.argv if argv is None else argv) if not rosgraph.names.is_legal_remap(arg)]


def on_shutdown(h: Callable[[], object]) -> None:
    """Lets a function be called when the node ends."""
    core.add_client_shutdown_hook(h)


def init_node(
    name: str,
    argv: list[str] | None = None,
    anonymous: bool = False,
    log_level: int | None = None,
    disable_rostime: bool = False,
    disable_rosout: bool = False,
    disable_signals: bool = False,
    xmlrpc_port: int = 0,
    tcpros_port: int = 0,
) -> None:
    """Makes the program a node; once, or again with the same arguments."""
    global _init_node_args
    if argv is None:
        argv = sys.argv
    else:
        names.reload_mappings(argv)
    if not name:
        raise ValueError("name must not be empty")
    if "/" in name:
        raise ValueError("namespaces are not allowed in node names")
    given = (name, argv, anonymous, log_level, disable_rostime, disable_signals)
    if _init_node_args:
        if _init_node_args != given:
            raise ROSException("rospy.init_node() has already been called with different arguments: " + str(_init_node_args))
        return
    _init_node_args = given
    if not disable_signals:
        core.register_signals()
    resolved = _resolved(name, anonymous)
    names._set_caller_id(resolved)
    names.initialize_mappings(resolved)
    link = the_exchange().link
    link.hello(resolved)
    link.on_end.append(core.at_end)
    core.set_node_uri("http://localhost:%d/" % (xmlrpc_port or 1))
    if core._shutdown_flag:
        raise ROSInitException("init_node interrupted before it could complete")
    log.begin(log_level)
    rostime.set_rostime_initialized(True)
    for parameter, value in _private(argv).items():
        set_param("~" + parameter, value)
    core.set_initialized(True)


def _resolved(name: str, anonymous: bool) -> str:
    mappings = names.get_mappings()
    if "__name" in mappings:
        name, anonymous = mappings["__name"], False
    if anonymous:
        import time

        name = "%s_%s_%s" % (name, os.getpid(), int(time.time() * 1000))
    if not rosgraph.names.is_legal_base_name(name):
        import warnings

        warnings.warn("'%s' is not a legal ROS base name. This may cause problems with other ROS tools." % name, stacklevel=3)
    return rosgraph.names.resolve_name(name, names.get_caller_id())


def _private(argv: list[str]) -> dict[str, Any]:
    """The node's own parameters among the arguments: `_name:=value`."""
    found = {}
    try:
        for arg in argv:
            if rosgraph.names.is_legal_remap(arg):
                source, target = (part.strip() for part in arg.split(":="))
                if source and target and len(source) > 1 and source[0] == "_" and source[1] != "_":
                    from rospy import words  # which few programs need

                    found[source[1:]] = words.value_of(target)
    except Exception as error:
        raise ROSInitException("invalid command-line parameters: %s" % error)
    return found


def load_command_line_node_params(argv: list[str]) -> dict[str, Any]:
    """The node's own parameters among the arguments."""
    return _private(argv)


def spin() -> None:
    """Lets other threads run until the node is ended."""
    if not core.is_initialized():
        raise ROSInitException("client code must call rospy.init_node() first")
    logdebug("node[%s, %s] entering spin(), pid[%s]", core.get_caller_id(), core.get_node_uri(), os.getpid())
    try:
        core.wait_for_shutdown()
    except KeyboardInterrupt:
        logdebug("keyboard interrupt, shutting down")
        signal_shutdown("keyboard interrupt")


def get_published_topics(namespace: str = "/") -> list[list[str]]:
    """Pairs of names and types of the topics that somebody publishes."""
    pairs = {
        (port["name"], port["type"])
        for port in graph.ports()
        if port["kind"] == "publisher" and port["name"].startswith(names.resolve_name(namespace))
    }
    return [list(pair) for pair in sorted(pairs)]


def wait_for_message(topic: str, topic_type: Any, timeout: Any = None) -> Any:
    """The next message of a topic; raises `ROSException` after the timeout (seconds, or a `Duration`)."""
    box = Mailbox()
    core._spinning.append(box)
    subscriber = None
    try:
        subscriber = Listener(topic, topic_type, box.put)
        if isinstance(timeout, genpy.Duration):
            timeout = timeout.to_sec()
        patience = None if timeout is None else max(1, round(timeout * 1e9))
        give_up = None if patience is None else the_exchange().time + patience
        the_exchange().awaits("subscriber", subscriber.resolved_name, subscriber.type, give_up)
        message = None if core.is_shutdown() else box.get(patience)
        while message.__class__ is Unreadable:
            logerr("unable to receive a message on topic %s: %s" % (subscriber.resolved_name, message.error))
            message = box.get(None if give_up is None else give_up - the_exchange().time)
    except ProtocolError as error:
        port = subscriber.impl.port if subscriber is not None and subscriber.impl is not None else None
        if port is not None and error.about is port:
            port.forget()
        raise
    finally:
        core._spinning.remove(box)
        if subscriber is not None:
            subscriber.unregister()
    if core.is_shutdown():
        raise ROSInterruptException("rospy shutdown")
    if message is None:
        raise ROSException("timeout exceeded while waiting for message on topic %s" % topic)
    return message


def get_master(env: Any = None) -> Any:
    """The master, as far as it tells what is there."""
    from rospy.msproxy import MasterProxy

    return MasterProxy("http://localhost:11311")
