"""The state of the node, its end, and its log."""

from __future__ import annotations

import _thread
import atexit
import sys
import time

from hrdsl import told
from hrdsl.errors import Stopped
from hrdsl.exchange import the_exchange
from rospy.log import (
    logdebug,
    logdebug_once,
    logdebug_throttle,
    logdebug_throttle_identical,
    logerr,
    logerr_once,
    logerr_throttle,
    logerr_throttle_identical,
    logerror,
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
    rospydebug,
    rospyerr,
    rospyinfo,
    rospywarn,
)
from rospy.names import get_caller_id, get_mappings, get_name, get_namespace, remap_name, resolve_name

__all__ = [
    "get_caller_id", "get_mappings", "get_name", "get_namespace", "get_node_uri", "get_ros_root", "is_initialized", "is_shutdown",
    "is_shutdown_requested", "logdebug", "logdebug_once", "logdebug_throttle", "logdebug_throttle_identical", "logerr", "logerr_once",
    "logerr_throttle", "logerr_throttle_identical", "logerror", "logfatal", "logfatal_once", "logfatal_throttle",
    "logfatal_throttle_identical", "loginfo", "loginfo_once", "loginfo_throttle", "loginfo_throttle_identical", "logout", "logwarn",
    "logwarn_once", "logwarn_throttle", "logwarn_throttle_identical", "parse_rosrpc_uri", "remap_name", "resolve_name", "rospydebug",
    "rospyerr", "rospyinfo", "rospywarn", "signal_shutdown",
]  # fmt: skip

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

_client_ready = False
_shutdown_flag = False
_in_shutdown = False
_hooks: dict[str, list[Callable[..., object]]] = {"client": [], "before": [], "internal": []}
_at_init: list[Callable[[], object]] = []  # what waits for the node
_spinning: list[Any] = []  # mailboxes of those who wait for the end
_node_uri: str | None = None


# ── the beginning ──


def is_initialized() -> bool:
    """Whether there is a node."""
    return _client_ready


def set_initialized(initialized: bool) -> None:
    """There is a node: what was declared before gets its connections."""
    global _client_ready
    _client_ready = initialized
    if initialized:
        waiting, _at_init[:] = _at_init[:], []
        for call in waiting:
            call()


def when_initialized(call: Callable[[], object]) -> None:
    """Calls it when there is a node; now, if there is one."""
    if _client_ready:
        call()
    else:
        _at_init.append(call)


def get_node_uri() -> str | None:
    """The node's address, which nobody can reach."""
    return _node_uri


def set_node_uri(uri: str) -> None:
    global _node_uri
    _node_uri = uri


def get_ros_root(required: bool = False, env: Any = None) -> Any:
    """`ROS_ROOT` of the environment."""
    import rospkg
    from rospy.exceptions import ROSException

    root = rospkg.get_ros_root(env)
    if required and not root:
        raise ROSException("ROS_ROOT is not set")
    return root


def parse_rosrpc_uri(uri: str) -> tuple[str, int]:
    """Host and port."""
    from rospy.exceptions import ParameterInvalid

    if not uri.startswith("rosrpc://"):
        raise ParameterInvalid("Invalid protocol for ROS service URL: %s" % uri)
    try:
        host, port = uri[len("rosrpc://") :].split("/")[0].split(":")
        return host, int(port)
    except ValueError:
        raise ParameterInvalid("ROS service URL is invalid: %s" % uri) from None


# ── the end ──


def is_shutdown() -> bool:
    """Whether the node has come to its end, or the test has."""
    exchange = the_exchange()
    exchange.polled("is_shutdown")
    return _shutdown_flag or exchange.link.stopped


def is_shutdown_requested() -> bool:
    return _in_shutdown


def failed(where: str, error: BaseException) -> None:
    """A callback has raised something: the node goes on, and the harness ends the test. Not when the node has come to its end."""
    if not _shutdown_flag:
        told.failed(get_name(), where, error)


def _add(kind: str, hook: Callable[..., object]) -> None:
    if not callable(hook):
        raise TypeError("shutdown hook [%s] must be a function or callable object: %s" % (hook, type(hook)))
    if not _shutdown_flag:
        _hooks[kind].append(hook)
    elif kind == "client":
        hook()
    else:
        hook("already shutdown")


def add_client_shutdown_hook(h: Callable[[], object]) -> None:
    """Lets a function of the program be called at the end, before all others."""
    _add("client", h)


def add_preshutdown_hook(h: Callable[[str], object]) -> None:
    """Lets a function be called with the reason, while topics still work."""
    _add("before", h)


def add_shutdown_hook(h: Callable[[str], object]) -> None:
    """Lets a function be called with the reason, when all is over."""
    _add("internal", h)


def signal_shutdown(reason: str) -> None:
    """Ends the node: calls what is to be called then, and wakes those who wait for the end."""
    global _shutdown_flag, _in_shutdown
    if _shutdown_flag or _in_shutdown:
        return
    _in_shutdown = True
    _call("client")
    _call("before", reason)
    _shutdown_flag = True
    for box in _spinning:
        box.put(reason)
    for hook in _hooks["internal"]:
        try:
            hook(reason)
        except Exception as error:
            sys.stderr.write("signal_shutdown hook error[%s]\n" % error)
    _hooks["internal"].clear()
    if reason != "atexit":
        try:
            time.sleep(0.1)  # as rospy does, so that others come to their ends
        except KeyboardInterrupt:
            pass


def _call(kind: str, *args: str) -> None:
    for hook in _hooks[kind]:
        try:
            hook(*args)
        except Stopped:  # the test is over, and with it all topics
            pass
        except BaseException:
            import traceback

            traceback.print_exc()
    _hooks[kind].clear()


def at_end() -> None:
    """The program has come to its end by itself: what it has registered for that is called while time can still pass, and the
    node is ended in its turn."""
    atexit._run_exitfuncs()


atexit.register(signal_shutdown, "atexit")


def wait_for_shutdown() -> None:
    """Lets time pass until the node is ended."""
    from hrdsl.mailbox import Mailbox

    box = Mailbox()
    _spinning.append(box)
    try:
        if not is_shutdown():
            box.get()
    finally:
        _spinning.remove(box)


def register_signals() -> None:
    """An interrupt ends the node."""
    import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`

    def end(number: int, frame: Any) -> None:
        scheduler = the_exchange().scheduler
        if scheduler.running is scheduler.main and scheduler.main.result is not None:
            signal_shutdown("signal-%d" % number)
        else:  # it waits, and cannot wait for the hooks as well
            _thread.start_new_thread(signal_shutdown, ("signal-%d" % number,))

    _signal.signal(_signal.SIGINT, end)
