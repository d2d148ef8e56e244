"""What is open in the system, asked again only when it has changed."""

from __future__ import annotations

from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class Graph:
    """The ports of all programs."""

    def __init__(self) -> None:
        self._ports: list[dict[str, str]] | None = None
        self._waiting: list[Mailbox] = []
        self._is_watched = False

    def ports(self) -> list[dict[str, str]]:
        """All of them."""
        exchange = the_exchange()
        if not self._is_watched:
            self._is_watched = True
            exchange.on_change(self._change)
        if self._ports is None:
            self._ports = exchange.listing()
        return self._ports

    def _change(self) -> None:
        self._ports = None
        for box in self._waiting:
            box.put("changed")

    def forget(self) -> None:
        """This program has changed it."""
        self._ports = None

    def programs(self, kind: str, name: str) -> list[str]:
        """The programs that have such a port."""
        return sorted({port["program"] for port in self.ports() if port["kind"] == kind and port["name"] == name})

    def type_of(self, name: str) -> str | None:
        """The type of a topic."""
        for port in self.ports():
            if port["name"] == name and port["kind"] in ("publisher", "subscriber"):
                return port["type"]
        return None

    def wait(self, is_so: Callable[[], Any], deadline: int | None) -> Any:
        """Waits until it is so, or until the deadline (nanoseconds): what it was at last."""
        box = Mailbox()
        self._waiting.append(box)
        try:
            while True:
                found = is_so()
                rest = None if deadline is None else deadline - the_exchange().time
                if found or rest is not None and rest <= 0:
                    return found
                box.get(rest)
        finally:
            self._waiting.remove(box)


graph = Graph()
