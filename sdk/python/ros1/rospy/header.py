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
        super().__init__(known)
        self._other = kind, name

    def __missing__(self, key: str) -> str:
        if key != "callerid":
            raise KeyError(key)
        programs = [port["program"] for port in graph.ports() if (port["kind"], port["name"]) == self._other]
        if len(programs) != 1:
            return "unknown"
        return get_caller_id() if programs[0] == the_exchange().link.program else "/" + programs[0]

    def __contains__(self, key: object) -> bool:
        return key == "callerid" or super().__contains__(key)

    def get(self, key: str, default: Any = None) -> Any:
        return self[key] if key in self else default
