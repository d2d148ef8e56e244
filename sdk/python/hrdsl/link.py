"""The connection to the harness: one JSON line out, one JSON line back (spec/protocol.md)."""

from __future__ import annotations

import _thread
import json
import os

from hrdsl.errors import ProtocolError, Stopped

TYPE_CHECKING = False  # as type checkers read it; `typing` takes longer to import than all of this package
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

VERSION = 2

#: The most bytes of a line.
LONGEST = 1 << 20

#: So many bytes of requests without replies wait for one that has a reply.
KEPT = 1 << 16

_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode
_scan = json.JSONDecoder().scan_once  # type: ignore[attr-defined, unused-ignore]
_get_ident = _thread.get_ident


class Link:
    """Sends requests one at a time and keeps the simulated time of the last reply."""

    def __init__(self) -> None:
        """Without a connection: code that runs before the test is known cannot make requests."""
        self._out = -1
        self._in: Any = None
        self._owner: int | None = None
        self._lock = _thread.allocate_lock()
        self.greeted = False  # whether there has been a `hello`
        self._stopped: str | None = None
        self._buffer: list[bytes] = []  # requests without replies that have not been written
        self._buffered = 0  # bytes of them
        self._told: list[tuple[object, int]] = []  # since the last reply: what each is about, and the thread
        self._lines = 0  # that had been written when the last reply came
        self.time = 0  # simulated nanoseconds at the last reply
        self.program = ""  # its name in the scenario
        self.faults: list[tuple[int, ProtocolError]] = []  # of requests without replies, to be raised by these threads
        self.backlog: list[dict[str, Any]] = []  # what has arrived before there is an exchange
        self.exchange: Any = None  # what hears of arrivals, when it is needed
        self.scheduler: Any = None  # of this process
        self.on_end: list[Callable[[], object]] = []  # called when the program has come to its end, before it says so
        self.before_request: Callable[[], object] | None = None  # called before each

    def connect(self, request_fd: int, reply_fd: int) -> None:
        """Makes the connection, of this process."""
        # Programs that the robot code starts must not hold the pipes open.
        os.set_inheritable(request_fd, False)
        os.set_inheritable(reply_fd, False)
        self._out = request_fd
        self._in = open(reply_fd, "rb")
        self._owner = os.getpid()

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
        answer = self._ask(_line(message))
        if self.faults:
            self._raise_fault()
        return answer

    def wait(self, until: int | None, give_up: int | None) -> dict[str, Any]:
        """The request `wait`. What was refused meanwhile is left in `faults`, so that no arrival is lost."""
        if until is None:
            limits = b"" if give_up is None else b',"give_up":%d' % give_up
        elif give_up is None:
            limits = b',"until":%d' % until
        else:
            limits = b',"until":%d,"give_up":%d' % (until, give_up)
        return self._ask(b'{"request":"wait"%s}\n' % limits)

    def tell(self, line: bytes, about: object) -> None:
        """Sends a request that has no reply, together with the next one that has; `about` is what an error calls it."""
        if not self.greeted:
            self.hello("program")
        if len(line) > LONGEST:
            raise ProtocolError(
                "%s: a message of %d bytes as JSON; a request has at most %d" % (about, len(line), LONGEST),
                "send less at once, such as smaller images",
            )
        if self._stopped is not None:
            raise Stopped(self._stopped)
        self._told.append((about, _get_ident()))
        self._buffer.append(line)
        self._buffered += len(line)
        if self._buffered > KEPT:
            self._check_owner()
            with self._lock:
                self._write(b"")

    def _check_owner(self) -> None:
        if self._owner is None:
            raise ProtocolError("no request can be made before the program begins")
        if os.getpid() != self._owner:
            raise ProtocolError(
                "a process forked from the program cannot make requests, nor wait (`time.sleep`)",
                "leave those to the program's first process",
            )

    def _ask(self, line: bytes) -> dict[str, Any]:
        self._check_owner()
        if self.before_request is not None:
            self.before_request()
        if not self.greeted:
            self.hello("program")
        with self._lock:
            if self._stopped is not None:
                raise Stopped(self._stopped)
            answer = self._exchange(line)
        if "error" in answer and "ok" not in answer:
            raise ProtocolError(answer["error"], answer.get("help"))
        return answer

    def sleep(self, seconds: float) -> None:
        """Lets simulated time pass."""
        self.request({"request": "sleep", "seconds": seconds})

    def _exchange(self, line: bytes) -> dict[str, Any]:
        try:
            self._write(line)
            said = self._in.readline()
        except OSError as error:
            self._stop("the harness has gone: %s" % error)
        if not said:
            self._stop("the harness has gone")
        answer: dict[str, Any] = _scan(said.decode("utf-8"), 0)[0]
        self.time = answer.get("t", self.time)
        if "refused" in answer:
            self._refused(answer["refused"])
        self._lines += len(self._told) + 1
        self._told.clear()
        if answer.get("stop"):
            self._stop(answer.get("reason", "the test is over"))
        return answer

    def _write(self, line: bytes) -> None:
        if self._buffer:
            self._buffer.append(line)
            line = b"".join(self._buffer)
            self._buffer.clear()
            self._buffered = 0
        sent = os.write(self._out, line)
        while sent < len(line):
            sent += os.write(self._out, line[sent:])

    def _refused(self, refused: list[dict[str, Any]]) -> None:
        for each in refused:
            at = each["line"] - self._lines - 1
            if 0 <= at < len(self._told):
                about, ident = self._told[at]
            else:  # the program has written to the pipe itself
                about, ident = "line %d" % each["line"], _get_ident()
            self.faults.append((ident, ProtocolError("%s: %s" % (about, each["error"]), each.get("help"))))

    def _raise_fault(self) -> None:
        me = _get_ident()
        for fault in self.faults:
            if fault[0] == me:
                self.faults.remove(fault)
                raise fault[1]

    def _stop(self, why: str) -> NoReturn:
        self._stopped = why
        raise Stopped(why)

    def done(self) -> None:
        """Says that the program has ended by itself; never raises."""
        try:
            self.request({"request": "done"})
        except (Stopped, ProtocolError):
            pass


def _line(message: dict[str, Any]) -> bytes:
    return _encode(message).encode("ascii") + b"\n"


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
