"""What this client library has below it: the exchange with the harness, and simulated time."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, NoReturn

    from hrdsl.exchange import Exchange

#: Simulated time 0 on clocks that tell the date: 2025-01-01 00:00:00 UTC, in nanoseconds.
EPOCH = 1735689600 * 10**9

_exchange: Exchange | None = None


def exchange() -> Exchange:
    """The one of this process, made at its first use."""
    global _exchange
    if _exchange is None:
        from hrdsl.exchange import the_exchange

        _exchange = the_exchange()
    return _exchange


def now() -> int:
    """Simulated nanoseconds, without counting as a look at the clock."""
    return exchange().time


def looked(what: str) -> None:
    """To be called by what a program may ask again and again, so that time passes for a loop that only asks."""
    exchange().polled(what)


def in_turn(works: list[Any]) -> list[Any]:
    """What is ready at once, in the order that the schedule draws; without one as it is."""
    if len(works) > 1:
        exchange().scheduler.shuffle(works)
    return works


def silently(call: Any, *args: Any) -> None:
    """For what a program cleans up after itself: when the test is over there is nobody left to tell."""
    from hrdsl.errors import ProtocolError, Stopped

    try:
        call(*args)
    except (Stopped, ProtocolError):
        pass


def unsupported(what: str, instead: str) -> NoReturn:
    """Refuses something of ROS 2 that does not exist here."""
    raise NotImplementedError("%s is not supported by hrdsl's rclpy: %s" % (what, instead))


# ── the graph ──

_ports: list[dict[str, str]] | None = None
_is_watching = False


def ports() -> list[dict[str, str]]:
    """All open ports of the system: `kind`, `name`, `type` and `program` of each."""
    global _ports, _is_watching
    there = exchange()
    if not _is_watching:
        _is_watching = True
        there.on_change(graph_changed)
    if _ports is None:
        _ports = there.listing()
    else:
        there.polled("graph")
    return _ports


def graph_changed() -> None:
    """What is known of the ports is not true any more."""
    global _ports
    _ports = None


def count(kind: str, name: str) -> int:
    """How many ports of this kind have this name."""
    return sum(1 for port in ports() if port["kind"] == kind and port["name"] == name)


def open_port(kind: str, name: str, type_name: str, handler: Any = None, **options: Any) -> Any:
    """Opens a port."""
    graph_changed()
    return exchange().open(kind, name, type_name, handler=handler, **options)


def close(port: Any) -> None:
    """Closes a port; when the test is over, nobody cares."""
    graph_changed()
    silently(port.close)


def awaits(kind: str, name: str, type_name: str, seconds: float | None) -> None:
    """Tells that the program waits for somebody at this name, for so long at most."""
    give_up = None if seconds is None or seconds == float("inf") else now() + round(seconds * 1e9)
    exchange().awaits(kind, name, type_name, give_up)
