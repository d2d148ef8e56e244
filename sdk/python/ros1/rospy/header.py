"""What a message knows of the connection by which it came."""

from __future__ import annotations

from hrdsl.exchange import the_exchange
from rospy.graph import graph
from rospy.names import get_caller_id

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class ConnectionHeader(dict):  # type: ignore[type-arg]
    """Texts by names. `callerid`, the node at the other end, is found out when it is asked for: `unknown` if there are several.
    A node of another program is called by the name of that."""

    def __init__(self, kind: str, name: str, **known: str) -> None:
        """`kind` is what the other end is at this name: a publisher, client or server."""
        super().__init__(known, callerid="")
        self._other = kind, name

    def with_latching(self) -> ConnectionHeader:
        """The same of a latched publisher."""
        found = ConnectionHeader(*self._other)
        found.update(self, latching="1")
        return found

    def _caller(self) -> str:
        programs = [port["program"] for port in graph.ports() if (port["kind"], port["name"]) == self._other]
        if len(programs) != 1:
            return "unknown"
        return get_caller_id() if programs[0] == the_exchange().link.program else "/" + programs[0]

    def __getitem__(self, key: str) -> Any:
        return self._caller() if key == "callerid" else super().__getitem__(key)

    def get(self, key: str, default: Any = None) -> Any:
        return self[key] if key in self else default

    def items(self) -> Any:
        return {key: self[key] for key in self}.items()

    def values(self) -> Any:
        return {key: self[key] for key in self}.values()

    def copy(self) -> dict[str, Any]:
        return dict(self.items())

    def __repr__(self) -> str:
        return repr(self.copy())
