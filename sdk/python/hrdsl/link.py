"""The connection to the harness: one JSON line out, one JSON line back (spec/protocol.md)."""

from __future__ import annotations

import _thread
import json
import os
import sys

from hrdsl.errors import Deadlock, ProtocolError, Stopped

TYPE_CHECKING = False  # as type checkers read it; `typing` takes longer to import than all of this package
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

VERSION = 2

#: The most bytes of a line.
LONGEST = 1 << 20

#: So many bytes of requests without replies wait for one that has a reply.
KEPT = 1 << 16

#: Later than any time of the harness.
_NEVER = (1 << 63) - 1

#: So many bytes are read at once; a reply is rarely longer.
_CHUNK = 1 << 14

_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode
_scan = json.JSONDecoder().scan_once  # type: ignore[attr-defined, unused-ignore]
_get_ident, _getpid, _read, _write = _thread.get_ident, os.getpid, os.read, os.write


class Link:
    """Sends requests one at a time and keeps the simulated time of the last reply. To the scheduler of the program's threads it is
    the world outside."""

    def __init__(self) -> None:
        """Without a connection: code that runs before the test is known cannot make requests."""
        self._out = -1
        self._in = -1
        self._owner: int | None = None
        self._lock = _thread.allocate_lock()
        self.greeted = False  # whether there has been a `hello`
        self._stopped: str | None = None
        self._buffer: list[bytes] = []  # requests without replies that have not been written
        self._buffered = 0  # bytes of them
        self._told: list[tuple[object, int]] = []  # since the last reply: what each is about, and the thread
        self._lines = 0  # that had been written when the last reply came
        self.time = 0  # simulated nanoseconds at the last reply
        self.asked = 0  # requests that have had a reply
        self.program = ""  # its name in the scenario
        self.faults: list[tuple[int, ProtocolError]] = []  # of requests without replies, to be raised by these threads
        self.backlog: list[dict[str, Any]] = []  # what has arrived before there is an exchange
        self.exchange: Any = None  # what hears of arrivals, when it is needed
        self.scheduler: Any = None  # of this process
        self.on_end: list[Callable[[], object]] = []  # called when the program has come to its end, before it says so
        self.before_request: Callable[[], object] | None = None  # called before each
        self.look: Callable[[], object] | None = None  # called where the program asks, and at the first it tells at an instant
        self._looked = (-1, 0)  # the instant at which somebody told something last, and the thread

    def connect(self, request_fd: int, reply_fd: int) -> None:
        """Makes the connection, of this process."""
        # Programs that the robot code starts must not hold the pipes open.
        os.set_inheritable(request_fd, False)
        os.set_inheritable(reply_fd, False)
        self._out = request_fd
        self._in = reply_fd
        self._owner = _getpid()

    @property
    def stopped(self) -> bool:
        """Whether the harness has ended the test."""
        return self._stopped is not None

    @property
    def why_stopped(self) -> str | None:
        """Why it has."""
        return self._stopped

    def is_ours(self) -> bool:
        """Whether this is the program itself, and no process forked from it."""
        return os.getpid() == self._owner

    def hello(self, name: str) -> None:
        """Names the program, and agrees on the protocol's version."""
        self.greeted = True
        answer = self.request({"request": "hello", "version": VERSION, "name": name})
        self.program = answer.get("program", self.program)

    def request(self, message: dict[str, Any]) -> dict[str, Any]:
        """Sends a request and waits for its reply; raises `Stopped` when the test is over."""
        return self.ask(_encode(message).encode("ascii") + b"\n")

    def ask(self, line: bytes) -> dict[str, Any]:
        """The same, of a request that is written already."""
        if self.look is not None:
            self.look()
        answer = self._ask(line)
        if self.faults:
            self._raise_fault()
        return answer

    def now(self) -> int:
        """The request `now`: simulated nanoseconds."""
        self.ask(b'{"request":"now"}\n')
        return self.time

    def wait(self, until: int | None, give_up: int | None) -> bool:
        """The request `wait`, and the handlers of what has arrived: whether it was given up. Raises `Deadlock` if nothing
        can end it."""
        limits = b"" if until is None else b',"until":%d' % min(until, _NEVER)
        if give_up is not None:
            limits += b',"give_up":%d' % min(give_up, _NEVER)
        if not limits and not self.can_arrive():
            raise Stopped(self.why_stopped or "") if self.stopped else Deadlock()
        answer = self._ask(b'{"request":"wait"%s}\n' % limits)
        arrivals = answer.get("arrivals")
        if arrivals:
            self._arrived(arrivals)
        if self.faults:
            self._hand_out_faults()
        return "gave_up" in answer

    def can_arrive(self) -> bool:
        """Whether something can arrive that a thread waits for."""
        return self.exchange is not None and self.exchange.expects()

    def _arrived(self, arrivals: list[dict[str, Any]]) -> None:
        if self.exchange is not None:
            self.exchange.take(arrivals)
        else:  # of events, which alone can arrive before, the newest are kept
            self.backlog.extend(arrivals)
            del self.backlog[:-1000]

    def tell(self, line: bytes, about: object) -> None:
        """Sends a request that has no reply, together with the next one that has; `about` is what an error calls it."""
        me = _get_ident()
        if self.look is not None and (self.time, me) != self._looked:
            self._looked = (self.time, me)  # the rest of what it tells now comes from the same loop, or from lines beside it
            self.look()
        size = len(line)
        if size > KEPT or self._stopped is not None or not self.greeted:
            self._check_told(size, about)
        self._told.append((about, me))
        self._buffer.append(line)
        self._buffered += size
        if self._buffered > KEPT:
            if _getpid() != self._owner:
                raise self._not_ours()
            with self._lock:
                self._write_rest(self._taken())

    def _check_told(self, size: int, about: object) -> None:
        if not self.greeted:
            self.hello("program")
        if size > LONGEST:
            raise ProtocolError(
                "%s: a message of %d bytes as JSON; a request has at most %d" % (about, size, LONGEST),
                "send less at once, such as smaller images",
            )
        if self._stopped is not None:
            raise Stopped(self._stopped)

    def _ask(self, line: bytes) -> dict[str, Any]:
        """What was refused meanwhile is left in `faults`, so that no arrival is lost."""
        if _getpid() != self._owner:
            raise self._not_ours()
        if self.before_request is not None:
            self.before_request()
        if not self.greeted:
            self.hello("program")
        with self._lock:
            if self._stopped is not None:
                raise Stopped(self._stopped)
            answer = self._exchange(line)
        self.asked += 1
        if "error" in answer and "ok" not in answer:
            raise ProtocolError(answer["error"], answer.get("help"))
        return answer

    def _not_ours(self) -> ProtocolError:
        if self._owner is None:
            return ProtocolError("no request can be made before the program begins")
        return ProtocolError(
            "a process forked from the program cannot make requests, nor wait (`time.sleep`)",
            "leave those to the program's first process",
        )

    def sleep(self, seconds: float) -> None:
        """Lets simulated time pass."""
        self.request({"request": "sleep", "seconds": seconds})

    def _exchange(self, line: bytes) -> dict[str, Any]:
        try:
            if self._buffer:
                self._buffer.append(line)
                line = self._taken()
            sent = _write(self._out, line)
            if sent < len(line):
                self._write_rest(line[sent:])
            said = _read(self._in, _CHUNK)
            if said[-1:] != b"\n":
                said = self._read_on(said)
        except OSError as error:
            self._stop("the harness has gone: %s" % error)
        answer: dict[str, Any] = _scan(said.decode(), 0)[0]
        if "t" in answer:
            self.time = answer["t"]
        if "refused" in answer:
            self._refused(answer["refused"])
        self._lines += len(self._told) + 1
        self._told.clear()
        if "stop" in answer and answer["stop"]:
            self._stop(answer.get("reason", "the test is over"))
        return answer

    def _read_on(self, said: bytes) -> bytes:
        """The rest of a reply that came in pieces."""
        pieces = [said]
        while pieces[-1][-1:] != b"\n":
            if not pieces[-1]:
                self._stop("the harness has gone")
            pieces.append(_read(self._in, _CHUNK))
        return b"".join(pieces)

    def _taken(self) -> bytes:
        """The lines that have not been written."""
        lines = b"".join(self._buffer)
        self._buffer.clear()
        self._buffered = 0
        return lines

    def _write_rest(self, lines: bytes) -> None:
        while lines:
            lines = lines[_write(self._out, lines) :]

    def _refused(self, refused: list[dict[str, Any]]) -> None:
        for each in refused:
            at = each["line"] - self._lines - 1
            if 0 <= at < len(self._told):
                about, ident = self._told[at]
            else:  # the program has written to the pipe itself
                about, ident = "line %d" % each["line"], _get_ident()
            fault = ProtocolError("%s: %s" % (about, each["error"]), each.get("help"))
            fault.about = about
            self.faults.append((ident, fault))

    def _hand_out_faults(self) -> None:
        """Of requests without a reply, to the threads that have made them; those that are not parked find out later."""
        for fault in list(self.faults):
            task = self.scheduler.tasks.get(fault[0]) or self.scheduler.main
            if task.result is None:
                self.faults.remove(fault)
                self.scheduler.unpark(task, fault[1])

    def _raise_fault(self) -> None:
        me = _get_ident()
        for fault in self.faults:
            if fault[0] == me:
                self.faults.remove(fault)
                raise fault[1]

    def _stop(self, why: str) -> NoReturn:
        self._stopped = why
        if self.exchange is not None and self.is_ours():
            sys.stderr.write(self.exchange.open_calls.report())
        raise Stopped(why)

    def done(self) -> None:
        """Says that the program has ended by itself; never raises."""
        try:
            self.request({"request": "done"})
        except (Stopped, ProtocolError):
            pass


_link: Link | None = None


def unconnected() -> Link:
    """The one connection of this process, before it is made."""
    global _link
    _link = Link()
    return _link


def the_link() -> Link:
    """The one connection of this process, made at the first use."""
    if _link is not None:
        return _link
    try:
        fds = int(os.environ.pop("HRDSL_REQUEST_FD")), int(os.environ.pop("HRDSL_REPLY_FD"))
    except (KeyError, ValueError):
        raise _no_harness() from None
    link = unconnected()
    link.connect(*fds)
    return link


def _no_harness() -> ProtocolError:
    if "HRDSL_SEED" in os.environ:
        return ProtocolError(
            "a process started by the program has no connection to the harness",
            "make the `hrdsl.Node` in the process that the scenario's `run` names",
        )
    return ProtocolError(
        "this program is not run by hrdsl, which plays its world",
        "start it with `hrdsl sim scenario.hri`, or with `hrdsl sim scenario.hri --test NAME` for one test",
    )
