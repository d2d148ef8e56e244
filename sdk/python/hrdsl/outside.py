"""Threads in simulated time: the scheduler over the connection to the harness, and all that waits through it."""

from __future__ import annotations

import os
import sys

from hrdsl import threads
from hrdsl.errors import Deadlock, Stopped
from hrdsl.replace import when_imported
from hrdsl.schedule import Scheduler

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.link import Link

#: Native libraries that compute in threads of their own; the machine has one core.
_POOLS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


class OverLink:
    """Time passes by one `sleep` request. Nothing arrives meanwhile: what the harness has to say waits in its mailbox
    until it is asked for."""

    def __init__(self, link: Link) -> None:
        self._link = link

    @property
    def time(self) -> int:
        """Simulated nanoseconds, at the last reply."""
        return self._link.time

    @property
    def stopped(self) -> bool:
        """Whether the test is over."""
        return self._link.stopped

    def wait(self, until: int | None) -> None:
        """Sleeps until then; without an end there is nothing to wait for."""
        if until is not None:
            self._link.request({"request": "sleep", "seconds": max(0, until - self._link.time) / 1e9})
        elif self._link.stopped:
            raise Stopped()
        else:
            raise Deadlock()


def install(link: Link) -> Scheduler:
    """Lets a scheduler run the threads of this process."""
    for name in _POOLS:
        os.environ.setdefault(name, "1")
    scheduler = Scheduler(OverLink(link), _number("HRDSL_SCHEDULE", int))
    made = threads.install(scheduler)
    _when_imported(scheduler)
    link.sleep = scheduler.sleep  # type: ignore[method-assign]
    budget = _number("HRDSL_BUSY_SECONDS", float)

    def watch() -> None:
        from hrdsl.watch import Watcher

        Watcher(scheduler, made, 10.0 if budget is None else budget).start()

    made.on_first = watch
    return scheduler


def _when_imported(scheduler: Scheduler) -> None:
    def patch(name: str) -> Callable[[Any], None]:
        def call(module: Any) -> None:
            from hrdsl import waits

            waits.PATCHES[name](module, scheduler)

        return call

    for name in ("select", "subprocess", "multiprocessing.process", "asyncio"):
        when_imported(name, patch(name))


def _number(name: str, kind: type[float]) -> int | None:
    value = os.environ.get(name)
    if not value:
        return None
    try:
        return kind(value)  # type: ignore[return-value]
    except ValueError:
        sys.exit("hrdsl: %s is %r, which is no number" % (name, value))
