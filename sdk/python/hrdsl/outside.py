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


#: Later than any time of the harness.
_NEVER = (1 << 63) - 1


class OverLink:
    """Time passes by requests to `wait`, whose arrivals go to the exchange."""

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

    def can_arrive(self) -> bool:
        """Whether something can arrive that a thread waits for."""
        exchange = self._link.exchange
        return exchange is not None and exchange.expects()

    def wait(self, until: int | None, give_up: int | None) -> bool:
        """One request, and its arrivals: whether it was given up."""
        link = self._link
        if until is None and give_up is None and not self.can_arrive():
            if link.stopped:
                raise Stopped(link.why_stopped or "")
            raise Deadlock()
        if until is not None and until > _NEVER:
            until = _NEVER
        if give_up is not None and give_up > _NEVER:
            give_up = _NEVER
        answer = link.wait(until, give_up)
        arrivals = answer.get("arrivals")
        if not arrivals:
            pass
        elif link.exchange is not None:
            link.exchange.take(arrivals)
        else:  # of events, which alone can arrive before, the newest are kept
            link.backlog.extend(arrivals)
            del link.backlog[:-1000]
        if link.faults:
            self._raise_faults()
        return "gave_up" in answer

    def _raise_faults(self) -> None:
        """Of requests without a reply, in the threads that have made them; those that are not parked find out later."""
        scheduler = self._link.scheduler
        for fault in list(self._link.faults):
            task = scheduler.tasks.get(fault[0]) or scheduler.main
            if task.result is None:
                self._link.faults.remove(fault)
                scheduler.unpark(task, fault[1])


def install(link: Link) -> Scheduler:
    """Lets a scheduler run the threads of this process."""
    for name in _POOLS:
        os.environ.setdefault(name, "1")
    scheduler = link.scheduler = Scheduler(OverLink(link), _number("HRDSL_SCHEDULE", int))
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
