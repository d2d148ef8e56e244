"""Which thread of the program runs: exactly one, until it has to wait.

The threads are real ones. One of them has the baton; each of the others sleeps in a lock of its own until the baton is
handed to it. It is handed over where a thread waits, yields or ends, and nowhere else, so that a program does the same in
every run. When all threads wait, the world outside lets time pass until the first of their deadlines.
"""

from __future__ import annotations

import _thread
import sys
import time
from collections import deque

from hrdsl.deadlines import Deadlines
from hrdsl.errors import ChildLives, Deadlock, Stopped

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Protocol

    class Outside(Protocol):
        """The world that has the time."""

        @property
        def time(self) -> int:
            """Simulated nanoseconds, now."""

        @property
        def stopped(self) -> bool:
            """Whether the test is over, so that no wait ends any more."""

        @property
        def asked(self) -> int:
            """How many requests have been answered."""

        def wait(self, until: int | None, give_up: int | None) -> bool:
            """Lets time pass until `until`, or something arrives, whose handlers may call `Scheduler.unpark`, or `give_up`, if
            nothing else happens at that instant: whether it was the last. Raises `Deadlock` if nothing can end it."""

        def can_arrive(self) -> bool:
            """Whether something can arrive that a thread waits for."""

    class Watch(Protocol):
        """A wait for descriptors, which the system's real time may end."""

        def look(self) -> bool:
            """Whether it is over, asked without waiting."""

        def descriptors(self) -> list[tuple[int, int]]:
            """What to poll for, as `select.poll` takes it."""


#: So many polls at one instant count as a wait, ...
POLLS = 1000

#: ... which lasts so long, in nanoseconds.
STEP = 1_000_000

# As they are before anything is replaced: this module is imported first.
real_lock = _thread.allocate_lock
real_sleep = time.sleep
real_monotonic = time.monotonic
real_clock = getattr(time, "clock_gettime", None)
_get_ident = _thread.get_ident


def _handle_pending() -> None:
    """Where a function of Python begins, the interpreter calls the handlers of signals."""


class Task:
    """A thread, as the scheduler sees it."""

    __slots__ = ("ident", "baton", "what", "result", "ticket", "has_yielded", "on_end", "gone", "is_dead")

    do: Callable[[], object] | None = None  # what is to be done at its turn, of an `Errand`

    def __init__(self, ident: int) -> None:
        self.ident = ident
        self.baton = real_lock()
        self.baton.acquire()
        self.what: Any = None  # it waits for
        self.result: bool | BaseException | None = True  # of its last wait: None while it waits
        self.ticket = 0  # of its deadline, if it has one
        self.has_yielded = False  # after polls, since its last wait
        self.on_end: list[Callable[[], object]] = []
        self.gone: Callable[[], object] | None = None  # returns when the system's thread has ended
        self.is_dead = False


class Errand(Task):
    """What a thread would do at its turn that then waits again: done by the thread that has the baton, which is cheaper by two switches
    between threads. It must not wait."""

    __slots__ = ("do",)

    def __init__(self, do: Callable[[], object]) -> None:
        self.do = do
        self.result, self.is_dead = True, False


class Scheduler:
    """The threads of a process."""

    def __init__(self, outside: Outside, seed: int | None = None) -> None:
        """`seed` lets chance choose the thread that runs next; by default it is the one that is ready for longest."""
        self.outside = outside
        self.running = self.main = Task(_get_ident())  # the thread that calls
        self.tasks: dict[int, Task] = {self.main.ident: self.main}
        self.ready: deque[Task] = deque()
        self.polls = 0
        self.calls = 0  # of the scheduler, so that others see that there are some
        self.watched: dict[Task, Watch] = {}
        self.look: Callable[[bool], bool] | None = None  # at the descriptors of `watched`
        self.ending: Callable[[], BaseException] | None = None  # what waits raise, once none can end
        self.failed = False  # whether the program ends by a fault that it cannot catch
        self.before_wait: Callable[[], object] | None = None  # called before each wait
        self.look_at_lines: Callable[[], object] | None = None  # called where a thread begins to wait
        self.children: dict[int, str] = {}  # processes that nobody has waited for: their commands by their numbers
        self._main_first = False
        self._deadlines = Deadlines()
        self._patience = Deadlines()  # those that come after all else that happens at their instants
        self._tickets = 0
        self._polled_at = -1
        self._ended: Callable[[], object] | None = None
        self._sender: Task | None = None  # of a signal to this process
        self._chance: Any = None
        if seed is not None:
            import _random

            self._chance = _random.Random(seed)

    # ── waiting ──

    def park(self, what: object, deadline: int | None = None, is_patient: bool = False) -> bool:
        """Lets others run until somebody calls `unpark` for the running thread, or until the deadline (simulated
        nanoseconds): whether it was the former. Who is patient waits for all else that happens at the instant of the
        deadline. Only for the thread that `current` has returned."""
        if self.children:
            self.refuse_wait()
        if self.before_wait is not None:
            self.before_wait()
        if self.look_at_lines is not None:
            self.look_at_lines()
        me = self.running
        me.what, me.result = what, None
        try:
            if deadline is None:
                self.polls, me.has_yielded = 0, False
            elif not (self.ready or self._deadlines.entries or self._patience.entries or self.watched) and not is_patient:
                if self._wait_alone(me, deadline):
                    me.what, me.result = None, True
                    return False
            else:
                self._set_deadline(me, deadline, is_patient)
            self._hand_over(me)
        except BaseException:  # of a handler of signals, in the main thread
            self._seize(me)
            raise
        me.what = None
        result = me.result
        if result is True or result is False:
            return result
        me.result = True
        raise result  # type: ignore[misc]

    def _wait_alone(self, me: Task, deadline: int) -> bool:
        """Of the only thread that waits for a time, while none is ready: whether nothing but its deadline has come. All else is
        as when there are several."""
        self.calls += 1
        if self.ending is None and deadline > self.outside.time:
            self.polls, me.has_yielded = 0, False
            try:
                self.outside.wait(deadline, None)
            except BaseException as error:
                self._set_deadline(me, deadline, False)
                self._failed(error)
                return False
            if me.result is None and not self.ready and self.outside.time >= deadline:
                return True
        if me.result is None:
            self._set_deadline(me, deadline, False)
        return False

    def _set_deadline(self, me: Task, deadline: int, is_patient: bool) -> None:
        self._tickets += 1
        me.ticket = self._tickets
        (self._patience if is_patient else self._deadlines).push(deadline, me)
        if deadline > self.outside.time:
            self.polls, me.has_yielded = 0, False
        elif not is_patient:  # no wait, but a look
            self.polls += 1

    def unpark(self, task: Task, result: bool | BaseException = True) -> None:
        """Makes a thread ready that waits; of any other this is none's business."""
        if task.result is None:
            task.result, task.ticket = result, 0
            self.ready.append(task)

    def errand(self, do: Callable[[], object]) -> None:
        """Lets it be called when it is its turn among the threads that are ready."""
        self.ready.append(Errand(do))

    def yield_(self) -> None:
        """Lets those run that are ready."""
        me = self.current()
        if me is not None and (self.ready or self._deadlines.entries):
            if self.children:
                self.refuse_wait()
            self.ready.append(me)
            self._hand_over(me)

    def sleep(self, seconds: float) -> None:
        """Waits for so long in simulated time; for nothing at all, lets the others run that are ready."""
        nanos = round(seconds * 1e9)
        if self.current() is None:
            real_sleep(seconds)
        elif nanos:
            self.park("sleep", self.outside.time + nanos)
        else:
            self.polled("sleep")
            self.yield_()

    def polled(self, kind: str = "") -> None:
        """To be called by what tells a program how things are: many such calls at one instant are a wait."""
        self.polls += 1
        if self.polls >= POLLS:
            self.much_polled()

    def much_polled(self) -> None:
        """Lets the others run; if they have, and this thread polls on, time passes."""
        self.polls = 0
        time = self.outside.time
        me = self.current() if time == self._polled_at else None
        self._polled_at = time
        if me is None:
            return
        if self.ready and not me.has_yielded:
            me.has_yielded = True
            self.yield_()
        else:
            self.park("polls", time + STEP)
            self._polled_at = self.outside.time

    # ── threads ──

    def current(self) -> Task | None:
        """The thread that calls, which has the baton then; None for one that the scheduler does not know, and for a
        handler of signals or a finalizer in a thread that waits, or is about to."""
        me = self.running
        ident = _get_ident()
        if me.ident == ident:
            return None if me.result is None else me
        task = self.tasks.get(ident)
        if task is None or task.result is None:
            return None
        self.ready.append(task)  # the main thread has taken the baton from it, after a signal
        task.baton.acquire()
        return task

    def begin(self, task: Task) -> None:
        """To be called first by a new thread: returns when it is its turn."""
        task.baton.acquire()
        self._confirm_end()
        self.polls = 0

    def add(self, task: Task) -> None:
        """A new thread is ready to run."""
        self.calls += 1
        self.tasks[task.ident] = task
        self.ready.append(task)

    def finish(self, task: Task) -> None:
        """To be called last by a thread that ends: hands the baton over for good."""
        self.current()
        for call in task.on_end:
            call()
        self.tasks.pop(task.ident, None)
        self.calls += 1
        chosen = self._next()
        if chosen is None:
            return
        self._ended = task.gone
        self.running = chosen
        chosen.baton.release()

    def fork(self) -> None:
        """In a process that was just forked: of all threads the one that called is left."""
        me = self.current() or self.main
        for task in self.tasks.values():
            if task is not me:
                task.is_dead, task.result = True, True
                for call in task.on_end:
                    call()
        self.main, self.tasks = me, {me.ident: me}
        self.ready.clear()
        self._deadlines.entries.clear()
        self._patience.entries.clear()
        self.watched.clear()
        self.children.clear()
        self._ended = None

    def begin_anew(self) -> None:
        """The program begins, in a process that was forked for it: what was imported before has not polled."""
        self.polls = self.calls = 0
        self.main.has_yielded = False
        self._polled_at = -1

    def end(self, error: Callable[[], BaseException]) -> None:
        """Ends the program by a fault: all waits raise it, that of the main thread first."""
        self.ending, self.failed, self._main_first = error, True, True
        main = self.main
        if main.result is None:
            self.unpark(main)
        if main in self.ready:
            self._main_first = False
            main.result = error()
            self.ready.remove(main)
            self.ready.appendleft(main)

    def refuse_wait(self) -> None:
        """Ends the program, unless it ends already: a child lives, and the calling thread is about to wait."""
        if self.ending is None:
            from hrdsl import report

            sys.stderr.write(report.child(self))
            self.end(ChildLives)
            raise ChildLives()

    def close(self) -> None:
        """The program has ended: polls are no waits any more, for time does not pass."""
        self.polls = -(1 << 60)

    def next_deadline(self) -> int | None:
        """The first deadline of those who wait."""
        both = (self._deadlines.first(), self._patience.first())
        return min((deadline for deadline in both if deadline is not None), default=None)

    # ── other orders ──

    @property
    def is_drawn(self) -> bool:
        """Whether chance says who is next among those that are ready."""
        return self._chance is not None

    def shuffle(self, items: list[Any]) -> None:
        """Puts what is ready at once into the order that the schedule draws; without one it stays as it is."""
        if self._chance is None:
            return
        for last in range(len(items) - 1, 0, -1):
            other = int(self._chance.random() * (last + 1))
            items[last], items[other] = items[other], items[last]

    # ── the baton ──

    def _hand_over(self, me: Task) -> None:
        self.calls += 1
        polls, ready = self.polls, self.ready
        if ready and not self._deadlines.entries and self._chance is None:
            chosen: Task | None = ready.popleft()
            if chosen is not None and chosen.do is not None:
                chosen.do()
                chosen = self._next()
        else:
            chosen = self._next()
        if chosen is me or chosen is None:
            return
        self.running = chosen
        chosen.baton.release()
        me.baton.acquire()
        self.polls = polls
        if self._ended is not None:
            self._confirm_end()
        while self._sender is not None:
            self._handle_signals(me)

    def _confirm_end(self) -> None:
        # What an ending thread leaves behind is torn down after its last line; nobody runs beside that.
        ended, self._ended = self._ended, None
        if ended is not None:
            ended()

    def signalled(self) -> None:
        """To be called after the process has sent itself a signal, which the main thread handles: if it is another that
        has sent it, that goes on when the signal is handled."""
        me = self.current()
        if me is not None and me is not self.main and self.main.ident in self.tasks:
            self._sender = me
            self.main.baton.release()
            me.baton.acquire()

    def _handle_signals(self, me: Task) -> None:
        _handle_pending()
        sender, self._sender = self._sender, None
        if me.what == "pause":  # the handler was what it has waited for
            self.unpark(me)
        if sender is not None:
            sender.baton.release()
            me.baton.acquire()

    def _seize(self, me: Task) -> None:
        """A signal ends the wait of the main thread, whoever runs: the other goes on when it is its turn again."""
        if self._sender is not None:
            me.baton.acquire(False)
            self.ready.appendleft(self._sender)
            self.running, self._sender = me, None
        elif self.running is not me and not me.baton.acquire(False):
            self.running = me
        if me in self.ready:
            self.ready.remove(me)
        me.what, me.ticket = None, 0
        if me.result is None:
            me.result = True

    def _next(self) -> Task | None:
        ready, deadlines = self.ready, self._deadlines.entries
        while True:
            if deadlines and deadlines[0][0] <= self.outside.time:
                self._expire(False)
            if not ready:
                self._idle()
                if not ready:
                    return None
            chosen: Task
            if self._chance is not None and len(ready) > 1:
                place = int(self._chance.random() * len(ready))
                chosen = ready[place]
                del ready[place]
            else:
                chosen = ready.popleft()
            if chosen.do is None:
                return chosen
            chosen.do()

    def _expire(self, gave_up: bool) -> None:
        time, tasks = self.outside.time, len(self.tasks)
        self._deadlines.expire(time, self.unpark, tasks)
        if self._patience.entries:
            self._patience.expire(time if gave_up else time - 1, self.unpark, tasks)

    # ── when all wait ──

    def _idle(self) -> None:
        while not self.ready:
            if self.ending is not None:
                if not self._wake_all(self.ending):
                    return
                continue
            until, give_up, gave_up = self._deadlines.first(), self._patience.first(), False
            try:
                if self.children:  # a thread has ended that has left one behind
                    self.refuse_wait()
                is_timeless = until is None and give_up is None
                if self.watched and self.look is not None:
                    if self.look(is_timeless and not self.outside.can_arrive()):
                        continue
                gave_up = self.outside.wait(until, give_up)
            except ChildLives:
                continue
            except Deadlock as found:
                if not any(task.result is None for task in self.tasks.values()):
                    return  # the last thread of a forked process ends
                self._found(found)
            except BaseException as error:
                self._failed(error)
            self._expire(gave_up)

    def _found(self, found: Deadlock) -> None:
        from hrdsl import report

        sys.stderr.write(report.deadlock(self))
        self.ending, self.failed, self._main_first = type(found), True, True

    def _failed(self, error: BaseException) -> None:
        """Whose wait raises it: all waits if the test is over, else that which it is about."""
        if isinstance(error, Stopped) and self.outside.stopped:
            self.ending = lambda: Stopped(error.why)
            return
        me = self.running
        if isinstance(error, Exception) and self.next_deadline() is not None:
            me = min(self._deadlines.entries[:1] + self._patience.entries[:1])[2]
        if me.result is not None:  # it ends, and waits for nothing
            me = self.main
        self.unpark(me, error)

    def _wake_all(self, error: Callable[[], BaseException]) -> bool:
        """The main thread is told at last, so that it finds the others gone; of a fault, at first."""
        waiting = [task for task in self.tasks.values() if task.result is None]
        others = [task for task in waiting if task is not self.main]
        if self._main_first and self.main in waiting:
            others = []
        self._main_first = False
        for task in others or waiting:
            self.unpark(task, error())
        return bool(waiting)
