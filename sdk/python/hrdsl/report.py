"""What is said of threads that wait for each other, of a loop that never waits, and of waits while a child process lives."""

from __future__ import annotations

import os
import sys

from hrdsl import locks

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any

    from hrdsl.schedule import Scheduler, Task

_OWN = os.path.dirname(os.path.abspath(__file__)) + os.sep
_CLIENTS = tuple(os.path.join(os.path.dirname(_OWN[:-1]), name) + os.sep for name in ("ros1", "ros2"))
_LIBRARY = os.path.dirname(os.path.abspath(os.__file__)) + os.sep


def deadlock(scheduler: Scheduler) -> str:
    """Who waits for what, where, and who has it."""
    frames = sys._current_frames()
    lines = ["hrdsl: deadlock: all threads of the program wait, and nothing can end that\n"]
    for task in scheduler.tasks.values():
        if task.result is None:
            what, place = _wait_of(frames.get(task.ident))
            told = name(scheduler, task), what, place and " at " + place, _holder(scheduler, task, what)
            lines.append("  %s waits in %s%s%s\n" % told)
    return "".join(lines)


def busy(scheduler: Scheduler, task: Task, seconds: float) -> str:
    """Where the loop is, and which waits let the others run."""
    place, wait = _loop_of(task)
    return (
        "hrdsl: %s: %s has computed for more than %g s of processor time while others wait to run; if this is a loop that waits for"
        " something, %s (HRDSL_BUSY_SECONDS sets the limit)\n" % (place, name(scheduler, task), seconds, wait)
    )


def silent(scheduler: Scheduler, task: Task, seconds: float) -> str:
    """Where a thread computes that keeps nobody from running, but makes no request either."""
    place, wait = _loop_of(task)
    return (
        "hrdsl: %s: %s has computed for more than %g s of processor time without a wait or a request, while no simulated time passes, and"
        " the limit of the program is near; if this is a loop that waits for something, %s\n"
        % (place, name(scheduler, task), seconds, wait)
    )


def _loop_of(task: Task) -> tuple[str, str]:
    """Where a thread computes, and how it would wait there."""
    frame = sys._current_frames().get(task.ident)
    _, place = _wait_of(frame)
    while frame is not None:
        if frame.f_code.co_filename.endswith(os.path.join("asyncio", "events.py")):
            return place, "wait with `await asyncio.sleep(seconds)`, or for an asyncio.Event"
        frame = frame.f_back
    waits = "wait with time.sleep, Event.wait(timeout) or a queue"
    for module, more in _WAITS.items():
        if module in sys.modules:
            return place, "%s, or with %s" % (waits, more)
    return place, waits


#: With what else programs wait that use one of these modules.
_WAITS = {
    "rclpy": "rclpy.spin_once(node)",
    "rospy": "rospy.sleep, or the sleep of a rospy.Rate",
    "hrdsl.node": "Node.wait_for or Node.sleep",
}


def child(scheduler: Scheduler) -> str:
    """Where the program waits while a child lives, and what to do instead."""
    from hrdsl import children

    _, place = _wait_of(sys._getframe(1))
    return "hrdsl: %ssimulated time is to pass, or another thread to run, while `%s` lives, a process that runs in real time; %s\n" % (
        place and place + ": ",
        next(iter(scheduler.children.values())),
        children.INSTEAD,
    )


def name(scheduler: Scheduler, task: Task) -> str:
    """The thread's name, as `threading` has it."""
    active: dict[int, Any] = getattr(sys.modules.get("threading"), "_active", {})
    thread = active.get(task.ident)
    if thread is not None:
        return "thread %s" % thread.name
    return "thread MainThread" if task is scheduler.main else "a thread without a name"


def site(frame: FrameType | None) -> str:
    """What the program's innermost line has called, and where."""
    what, place = _wait_of(frame)
    return what + (place and " at " + place)


def _wait_of(frame: FrameType | None) -> tuple[str, str]:
    """What the program's innermost line has called, and its place."""
    called = None
    while frame is not None and frame.f_code.co_filename.startswith((_OWN, _LIBRARY, "<frozen", *_CLIENTS)):
        if _is_site(frame):
            break
        if frame.f_code.co_name == "run" and frame.f_code.co_filename.endswith("threading.py"):
            return _title(called), ""  # the target of a thread
        if not frame.f_code.co_filename.startswith((_OWN + "run", _OWN + "threads")):
            called = frame
        frame = frame.f_back
    if frame is None:
        return "the end of the program", ""
    return _title(called), "%s:%d" % (frame.f_code.co_filename, frame.f_lineno)


def _is_site(frame: FrameType) -> bool:
    return "-packages" + os.sep in frame.f_code.co_filename


def _title(frame: FrameType | None) -> str:
    if frame is None:
        return "a wait"
    code = frame.f_code
    owner = frame.f_locals.get("self")
    if code.co_filename.startswith(_OWN):
        if isinstance(owner, (locks.lock, locks.RLock)):
            return "RLock" if isinstance(owner, locks.RLock) else "Lock"
        if isinstance(owner, locks.SimpleQueue):
            return "SimpleQueue.get"
        return code.co_name.strip("_")
    return code.co_name if owner is None else "%s.%s" % (type(owner).__name__, code.co_name)


def _holder(scheduler: Scheduler, task: Task, what: str) -> str:
    if what.endswith("program"):
        return " for its other threads"  # for which of them first is no order that a program has chosen
    waited = task.what
    if not isinstance(waited, (locks.lock, locks.RLock)):
        return ""
    owner = waited._owner
    if isinstance(owner, int):
        owner = scheduler.tasks.get(owner)
    if owner is task and what not in ("Lock", "RLock"):
        return ""  # the lock of a condition's waiter is its own
    if owner is None or owner.ident not in scheduler.tasks:
        by = "a thread that has ended"
    else:
        by = "itself" if owner is task else name(scheduler, owner)
    return " for %s" % by if what.endswith(".join") else ", held by %s" % by
