"""The default context, and what asks it."""

from __future__ import annotations

import sys

from rclpy.constants import S_TO_NS
from rclpy.context import Context

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Iterable

g_default_context: Context | None = None


def get_default_context(*, shutting_down: bool = False) -> Context:
    """The one that is meant where none is named; there is a new one after each shutdown."""
    global g_default_context
    context = g_default_context
    if context is None:
        context = g_default_context = Context()
    if shutting_down:
        g_default_context = None
    return context


def remove_ros_args(args: Iterable[str] | None = None) -> list[str]:
    """The arguments that are the program's own."""
    from rclpy._arguments import Arguments

    return Arguments(sys.argv if args is None else args).others


def ok(*, context: Context | None = None) -> bool:
    """Whether the context has begun and not ended."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Ends the context."""
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Ends the context, if it has not ended."""
    global g_default_context
    if context is not None:
        context.try_shutdown()
        return
    default = get_default_context()
    default.try_shutdown()
    g_default_context = None


def get_rmw_implementation_identifier() -> str:
    """What carries messages: hrdsl's harness."""
    return "rmw_hrdsl"


def get_available_rmw_implementations() -> set[str]:
    """There is one."""
    return {"rmw_hrdsl"}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Whole nanoseconds; -1 for ever, which None and what is negative mean."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return int(float(timeout_sec) * S_TO_NS)
