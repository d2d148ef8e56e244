"""What the programs of a system say to each other and to the world: topics, services, actions, commands and events, as
protocol 2 has them (spec/protocol.md).

Handlers are called with what has arrived while all threads wait. They must not wait themselves: they put things where
threads find them (`hrdsl.mailbox.Mailbox`, a `deque`).
"""

from __future__ import annotations

import json

from hrdsl import link as _links
from hrdsl.errors import ProtocolError
from hrdsl.events import EventBox
from hrdsl.open_calls import OpenCalls

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Union

    Arrival = dict[str, Any]
    Handler = Callable[[Arrival], object]
    Message = Union[bytes, Any]  # bytes are JSON already

_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode

#: Kinds of ports at which something arrives by itself.
_HEARING = ("subscriber", "server", "action_server")


def the_exchange() -> Exchange:
    """The one of this process, made at the first use."""
    link = _links._link or _links.the_link()
    exchange: Exchange | None = link.exchange
    if exchange is None:
        exchange = Exchange(link)
    return exchange


class Port:
    """A publisher, subscriber, server or client of this program."""

    __slots__ = ("number", "kind", "name", "type_name", "on_incompatible", "_exchange", "_tell", "_publish", "_handler")

    def __init__(self, exchange: Exchange, number: int, kind: str, name: str, type_name: str, handler: Handler | None) -> None:
        self.number, self.kind, self.name, self.type_name = number, kind, name, type_name
        #: Called with `reliability` or `durability` when one at the other side requests, or offers, what does not fit.
        self.on_incompatible: Callable[[str], object] | None = None
        self._exchange: Exchange | None = exchange
        self._tell = exchange.link.tell
        self._publish = b'{"request":"publish","port":%d,"message":' % number
        self._handler = handler

    def publish(self, message: Message) -> None:
        """Sends a message, which goes out with the next request that waits."""
        if self._exchange is None:
            raise self._closed()
        if message.__class__ is not bytes:
            message = _encode(message).encode("ascii")
        self._tell(self._publish + message + b"}\n", self)

    def line(self, message: bytes) -> bytes:
        """The request that sends a message, for `Link.tell`."""
        return self._publish + message + b"}\n"

    def call(self, message: Message, handler: Handler) -> Call:
        """Asks the service, or gives the action a goal; the handler gets what comes of it."""
        exchange = self._exchange
        if exchange is None:
            raise self._closed()
        call = Call(exchange, exchange.number(), self)
        text = message if isinstance(message, bytes) else _encode(message).encode("ascii")
        exchange.calls[call.number] = handler
        if self.kind == "client":
            exchange.open_calls.ask(call.number, self, exchange.time)
        try:
            self._tell(b'{"request":"call","port":%d,"call":%d,"message":%s}\n' % (self.number, call.number, text), self)
        except BaseException:
            del exchange.calls[call.number]
            exchange.open_calls.answered(call.number)
            raise
        return call

    def cancel_all(self) -> None:
        """Asks the server of an action to end all goals that it has, whoever gave them."""
        if self._exchange is None:
            raise self._closed()
        self._tell(b'{"request":"cancel","port":%d}\n' % self.number, self)

    def close(self) -> None:
        """Nothing arrives any more, and nothing can be sent."""
        if self._exchange is not None:
            self.forget()
            self._tell(b'{"request":"close","port":%d}\n' % self.number, self)

    def forget(self) -> None:
        """Nothing arrives any more, and nothing can be sent; the harness does not hear of it, as of a port that it has refused."""
        exchange, self._exchange = self._exchange, None
        if exchange is not None:
            exchange.ports.pop(self.number, None)

    def _closed(self) -> ProtocolError:
        return ProtocolError("the %s is closed" % self)

    def __str__(self) -> str:
        return "%s of %s (%s)" % (self.kind.replace("_", " "), self.name, self.type_name)


class Call:
    """A question to a service, or a goal of an action."""

    __slots__ = ("number", "_exchange", "_port")

    def __init__(self, exchange: Exchange, number: int, port: Port) -> None:
        self._exchange = exchange
        self.number = number
        self._port = port

    def cancel(self) -> None:
        """Asks the server of an action to end the goal; nothing, once that has ended."""
        if self.number in self._exchange.calls:
            self._exchange.link.tell(b'{"request":"cancel","call":%d}\n' % self.number, self._port)


class Exchange:
    """This program's side of all of it."""

    def __init__(self, link: _links.Link) -> None:
        self.link = link
        self.scheduler = link.scheduler or _scheduler(link)
        self.events = EventBox(self)
        self.ports: dict[int, Port] = {}  # that are open
        self.calls: dict[int, Handler] = {}  # that have not ended
        self.open_calls = OpenCalls()
        self.parked = 0  # threads that wait for what arrives
        self._commands: dict[int, Callable[[str | None], object]] = {}
        self._listeners: list[Handler] = []  # to events
        self._watchers: list[Callable[[], object]] = []  # of the graph
        self._last = 0  # number of a port or call
        link.exchange = self
        self.take(link.backlog)
        link.backlog = []

    @property
    def time(self) -> int:
        """Simulated nanoseconds, at the last reply."""
        return self.link.time

    def number(self) -> int:
        """One that no port and no call has."""
        self._last += 1
        return self._last

    def polled(self, kind: str = "") -> None:
        """To be called by what tells a program how things are: many such calls at one instant are a wait."""
        self.scheduler.polled(kind)

    # ── ports ──

    def open(
        self,
        kind: str,
        name: str,
        type_name: str,
        *,
        latched: bool = False,
        depth: int | None = None,
        reliability: str | None = None,
        durability: str | None = None,
        handler: Handler | None = None,
        is_told: bool = False,
    ) -> Port:
        """Becomes a `publisher`, `subscriber`, `server`, `client`, `action_server` or `action_client`. What arrives at the
        port goes to the handler. The reliability is `reliable` or `best_effort`, the durability `volatile` or
        `transient_local`; None fits all. Raises `ProtocolError` if it is refused; if it `is_told`, the next request that has a
        reply does, of which the error is `about` the port."""
        port = Port(self, self.number(), kind, name, type_name, handler)
        message: dict[str, Any] = {"request": "open", "port": port.number, "kind": kind, "name": name, "type": type_name}
        if latched:
            message["latched"] = True
        for key, value in (("depth", depth), ("reliability", reliability), ("durability", durability)):
            if value is not None:
                message[key] = value
        self.ports[port.number] = port
        try:
            if is_told:
                message["reply"] = False
                self.link.tell(_encode(message).encode("ascii") + b"\n", port)
            else:
                self.link.request(message)
        except BaseException:
            self.ports.pop(port.number, None)
            raise
        return port

    def awaits(self, kind: str, name: str, type_name: str | None = None, give_up: int | None = None) -> None:
        """Tells that the program waits, until `give_up` (nanoseconds) at most, for somebody at a name, where it is of this
        kind itself: a `client` for a server, a `subscriber` for a publisher."""
        message: dict[str, Any] = {"request": "await", "kind": kind, "name": name}
        if type_name is not None:
            message["type"] = type_name
        if give_up is not None:
            message["give_up"] = give_up
        self.tell(message)

    def listing(self) -> list[dict[str, str]]:
        """All open ports of the system: `kind`, `name`, `type` and `program` of each."""
        ports: list[dict[str, str]] = self.link.request({"request": "list"})["ports"]
        return ports

    def on_change(self, handler: Callable[[], object]) -> None:
        """Lets it be called once when ports have been opened or closed since `listing`."""
        self._watchers.append(handler)

    # ── the side of a server ──

    def respond(self, number: int, message: Message) -> None:
        """Answers a call of a service, by the number with which it arrived."""
        self.open_calls.answer(number)
        self._about_call(b'{"request":"respond","call":%d,"message":%s}\n', number, message)

    def refuse(self, number: int, text: str) -> None:
        """Answers it with an error."""
        self.open_calls.answer(number)
        self._about_call(b'{"request":"respond","call":%d,"error":%s}\n', number, text)

    def accept(self, number: int, text: str = "") -> None:
        """Takes a goal on, with words for its client."""
        self._about_call(b'{"request":"accept","call":%d,"text":%s}\n', number, text)

    def feedback(self, number: int, message: Message) -> None:
        """Tells how far a goal is."""
        self._about_call(b'{"request":"feedback","call":%d,"message":%s}\n', number, message)

    def answer_cancel(self, number: int, granted: bool, text: str = "") -> None:
        """Says whether a goal that is to end before it is reached will be canceled."""
        line = b'{"request":"answer_cancel","call":%%d,"granted":%s,"text":%%s}\n' % (b"true" if granted else b"false")
        self._about_call(line, number, text)

    def finish(self, number: int, end: str, message: Message, text: str = "") -> None:
        """Ends a goal: it is `succeeded`, `aborted`, `canceled` or `rejected`."""
        words = (_encode(end).encode("ascii"), _encode(text).replace("%", "%%").encode("ascii"))
        line = b'{"request":"finish","call":%%d,"end":%s,"text":%s,"message":%%s}\n' % words
        self._about_call(line, number, message)

    def _about_call(self, line: bytes, number: int, message: Message) -> None:
        text = message if isinstance(message, bytes) else _encode(message).encode("ascii")
        self.link.tell(line % (number, text), "the answer to call %d" % number)

    # ── the world ──

    def act(self, device: str, command: str, args: dict[str, Any], handler: Callable[[str | None], object]) -> None:
        """Begins a command of a device; the handler is told at its end why it has failed, or None. Raises `ProtocolError` if
        there is no such command."""
        number = self.number()
        self._commands[number] = handler
        message = {"request": "act", "on": device, "do": command, "args": args, "wait": False, "call": number}
        try:
            answer = self.link.request(message)
        except BaseException:
            del self._commands[number]
            raise
        if answer.get("ok") is False:  # it could not be begun
            del self._commands[number]
            handler(answer.get("error") or "it could not be begun")

    def on_event(self, handler: Handler) -> None:
        """Lets it be called with each event that the program's actor hears: `name`, `args` and `time` (nanoseconds)."""
        self._listeners.append(handler)

    def read(self, signal: str) -> Any:
        """The present value of a signal."""
        return self.link.request({"request": "read", "signal": signal})["value"]

    def state(self, device: str, what: str) -> list[float]:
        """How a device is now, in SI units; numbers may be infinite, or NaN."""
        return [float(each) for each in self.link.request({"request": "state", "device": device, "what": what})["value"]]

    def declare(self, machine: str, states: list[str], transitions: list[list[str]], outcomes: list[str]) -> None:
        """Tells what a state machine consists of: its transitions are lists of a state, an outcome of it and what is next."""
        self.tell({"request": "machine", "name": machine, "states": states, "transitions": transitions, "outcomes": outcomes})

    def begin(self, machine: str, state: str) -> None:
        """Tells that a state machine begins, in this state."""
        self.tell({"request": "transition", "machine": machine, "next": state})

    def transition(self, machine: str, label: str, state: str, outcome: str, next: str) -> None:
        """Tells that a state machine has moved."""
        self.tell({
            "request": "transition", "machine": machine, "label": label, "state": state, "outcome": outcome, "next": next,
        })  # fmt: skip

    def tell(self, message: dict[str, Any]) -> None:
        """Sends a request of any kind that has no reply."""
        self.link.tell(_encode(message).encode("ascii") + b"\n", message["request"])

    # ── what arrives ──

    def expects(self) -> bool:
        """Whether something may arrive that ends a wait."""
        if self.parked or self.calls or self._commands or self._listeners or self._watchers:
            return True
        return any(port.kind in _HEARING for port in self.ports.values())

    def park(self, what: object, deadline: int | None) -> bool:
        """Lets the calling thread wait for what arrives, and hear what comes at the very deadline (nanoseconds): whether it
        was woken by `Scheduler.unpark`. A thread that the scheduler does not run waits for the next arrival."""
        me = self.scheduler.current()
        self.parked += 1
        try:
            if me is not None:
                woken: bool = self.scheduler.park(what, deadline, True)
                return woken
            return not self.scheduler.outside.wait(None, deadline)
        finally:
            self.parked -= 1

    def take(self, arrivals: list[Arrival]) -> None:
        """Calls the handlers of what has arrived, in its order."""
        for arrival in arrivals:
            number = arrival.get("port")
            if number is not None:
                port = self.ports.get(number)
                if port is not None and port._handler is not None:
                    if port.kind == "server":
                        self.open_calls.arrive(arrival["called"], port, self.time)
                    port._handler(arrival)
            elif "event" in arrival:
                self.events.arrived(arrival["event"])
                for listener in self._listeners:
                    listener(arrival["event"])
            else:
                self._take_rare(arrival)

    def _take_rare(self, arrival: Arrival) -> None:
        if "ended" in arrival:
            ended = self._commands.pop(arrival["ended"], None)
            if ended is not None:
                ended(None if arrival.get("ok") else arrival.get("error") or "it failed")
        elif "feedback" in arrival or "accepted" in arrival or "cancel_answered" in arrival:
            kind = next(kind for kind in ("feedback", "accepted", "cancel_answered") if kind in arrival)
            handler = self.calls.get(arrival[kind])
            if handler is not None:
                handler(arrival)
        elif "answered" in arrival or "finished" in arrival:
            number = arrival["answered" if "answered" in arrival else "finished"]
            handler = self.calls.pop(number, None)
            self.open_calls.answered(number)
            if handler is not None:
                handler(arrival)
        elif "incompatible" in arrival:
            port = self.ports.get(arrival["incompatible"])
            if port is not None and port.on_incompatible is not None:
                port.on_incompatible(arrival["policy"])
        elif "changed" in arrival:
            for watcher in self._watchers:
                watcher()


def _scheduler(link: _links.Link) -> Any:
    """Of a program that does not run through `hrdsl.run`: nothing is replaced, and threads that it starts wait one by one."""
    from hrdsl.schedule import Scheduler

    link.scheduler = Scheduler(link)
    return link.scheduler
