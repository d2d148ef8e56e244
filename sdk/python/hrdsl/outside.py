"""Threads in simulated time: the scheduler over the connection to the harness, and all that waits through it."""

from __future__ import annotations

import os
import sys

from hrdsl import alarms, children, threads
from hrdsl.replace import when_imported
from hrdsl.schedule import Scheduler
from hrdsl.watch import Watcher

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.link import Link

#: Native libraries that compute in threads of their own; the machine has one core.
_POOLS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def install(link: Link) -> tuple[Scheduler, Callable[[], None]]:
    """Lets a scheduler run the threads of this process. What it returns besides is to be called when the program begins, and has it
    watched for loops that never wait."""
    for name in _POOLS:
        os.environ.setdefault(name, "1")
    scheduler = link.scheduler = Scheduler(link, _number("HRDSL_SCHEDULE", int))
    made = threads.install(scheduler)
    alarms.install(scheduler, made)
    children.install()
    _when_imported(scheduler)
    link.sleep = scheduler.sleep  # type: ignore[method-assign]
    budget = _number("HRDSL_BUSY_SECONDS", float)

    def watch() -> None:
        Watcher(scheduler, made, 10.0 if budget is None else budget).start()

    return scheduler, watch


def _when_imported(scheduler: Scheduler) -> None:
    def patch(name: str) -> Callable[[Any], None]:
        def call(module: Any) -> None:
            from hrdsl import waits

            waits.PATCHES[name](module, scheduler)

        return call

    for name in ("select", "subprocess", "_multiprocessing", "multiprocessing.connection", "multiprocessing.process", "asyncio"):
        when_imported(name, patch(name))


def _number(name: str, kind: type[float]) -> int | None:
    value = os.environ.get(name)
    if not value:
        return None
    try:
        return kind(value)  # type: ignore[return-value]
    except ValueError:
        sys.exit("hrdsl: %s is %r, which is no number" % (name, value))
