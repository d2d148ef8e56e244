"""What is said of an exception that leaves a callback: of which node it is, and what it was called for.

It leaves `spin`, as in ROS. Where that ends the program, the line under the traceback says it; where it ends a thread that spins, or
the program catches it, nobody else would be told, and the harness is.
"""

from __future__ import annotations

import threading

from hrdsl import told
from rclpy import _world

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


def keep(error: BaseException, node: Any, entity: Any) -> None:
    """Keeps with an exception where it was raised."""
    told.place(error, node.get_fully_qualified_name(), _in_words(entity))


def leave(error: BaseException) -> None:
    """An exception of a callback leaves the executor."""
    told.left(error, _world.exchange().scheduler)


def _in_words(entity: Any) -> str:
    port = getattr(entity, "_port", None)
    if port is not None:
        return str(port)
    period = getattr(entity, "timer_period_ns", None)
    if period is not None:
        return "timer of %g s" % (period / 1e9)
    return type(entity).__name__


def watch_threads() -> None:
    """Tells the harness of such exceptions that end a thread."""
    report = threading.excepthook

    def hook(args: Any, /) -> None:
        report(args)
        told.ended_by(args.exc_value)
        place = told.place_of(args.exc_value)
        if place is not None:
            told.failed(*place, args.exc_value)

    threading.excepthook = hook
