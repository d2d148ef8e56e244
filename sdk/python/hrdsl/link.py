"""The connection to the harness: one JSON line out, one JSON line back (spec/protocol.md)."""

from __future__ import annotations

import _thread
import json
import os

from hrdsl.errors import ProtocolError, Stopped

TYPE_CHECKING = False  # as type checkers read it; `typing` takes longer to import than all of this package
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

VERSION = 1

_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode
_decode = json.JSONDecoder().decode


class Link:
    """Sends requests one at a time and keeps the simulated time of the last reply."""

    def __init__(self, request_fd: int, reply_fd: int) -> None:
        # Programs that the robot code starts must not hold the pipes open.
        os.set_inheritable(request_fd, False)
        os.set_inheritable(reply_fd, False)
        self._out = request_fd
        self._in = open(reply_fd, "rb")
        self._owner = os.getpid()
        self._lock = _thread.allocate_lock()
        self._greeted = False
        self._stopped: str | None = None
        self.time = 0  # simulated nanoseconds at the last reply
        self.before_request: Callable[[], object] | None = None  # called before each

    @property
    def stopped(self) -> bool:
        """Whether the harness has ended the test."""
        return self._stopped is not None

    def is_ours(self) -> bool:
        """Whether this is the program itself, and no process forked from it."""
        return os.getpid() == self._owner

    def hello(self, name: str) -> None:
        """Names the program, and agrees on the protocol's version."""
        self._greeted = True
        self.request({"request": "hello", "version": VERSION, "name": name})

    def request(self, message: dict[str, Any]) -> dict[str, Any]:
        """Sends a request and waits for its reply; raises `Stopped` when the test is over."""
        if os.getpid() != self._owner:
            raise ProtocolError(
                "a process forked from the program cannot make requests, nor wait (`time.sleep`)",
                "leave those to the program's first process",
            )
        if self.before_request is not None:
            self.before_request()
        if not self._greeted:
            self.hello("program")
        line = _encode(message).encode("ascii") + b"\n"
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
            sent = os.write(self._out, line)
            while sent < len(line):
                sent += os.write(self._out, line[sent:])
            said = self._in.readline()
        except OSError as error:
            self._stop("the harness has gone: %s" % error)
        if not said:
            self._stop("the harness has gone")
        answer: dict[str, Any] = _decode(said.decode("utf-8"))
        self.time = answer.get("t", self.time)
        if answer.get("stop"):
            self._stop("the test is over")
        return answer

    def _stop(self, why: str) -> NoReturn:
        self._stopped = why
        raise Stopped(why)

    def done(self) -> None:
        """Says that the program has ended by itself; never raises."""
        try:
            self.request({"request": "done"})
        except (Stopped, ProtocolError):
            pass


_link: Link | None = None


def the_link() -> Link:
    """The one connection of this process, made at the first use."""
    global _link
    if _link is None:
        try:
            fds = int(os.environ.pop("HRDSL_REQUEST_FD")), int(os.environ.pop("HRDSL_REPLY_FD"))
        except (KeyError, ValueError):
            raise _no_harness() from None
        _link = Link(*fds)
    return _link


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
