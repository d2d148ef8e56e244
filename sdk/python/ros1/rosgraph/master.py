"""The master, as far as it tells what is there."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class MasterException(Exception):
    """The base of what goes wrong with the master."""


class MasterFailure(MasterException):
    """The master could not do it."""


class MasterError(MasterException):
    """The master was asked for something that there is not."""


class Error(MasterError):
    """As `MasterError`."""


class Master:
    """Asks what is open in the system."""

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.caller_id = caller_id
        self.master_uri = "http://localhost:11311"

    def _ports(self) -> list[dict[str, str]]:
        from hrdsl.exchange import the_exchange

        ports: list[dict[str, str]] = the_exchange().listing()
        return ports

    def getPid(self) -> int:
        return 1

    def getUri(self) -> str:
        return self.master_uri

    def getPublishedTopics(self, subgraph: str = "/") -> list[list[str]]:
        """Pairs of names and types."""
        return _pairs(port for port in self._ports() if port["kind"] == "publisher" and port["name"].startswith(subgraph))

    def getTopicTypes(self) -> list[list[str]]:
        """Pairs of names and types."""
        return _pairs(port for port in self._ports() if port["kind"] in ("publisher", "subscriber"))

    def getSystemState(self) -> list[Any]:
        """Publishers, subscribers and services, each with the names of their nodes."""
        ports = self._ports()
        return [_holders(ports, kind) for kind in ("publisher", "subscriber", "server")]

    def lookupService(self, service: str) -> str:
        for port in self._ports():
            if port["kind"] == "server" and port["name"] == service:
                return "rosrpc://localhost:1"
        raise MasterError("no provider")

    def getParam(self, key: str) -> Any:
        from rospy.params import tree

        try:
            return tree().get(key)
        except KeyError:
            raise MasterError("Parameter [%s] is not set" % key) from None

    def hasParam(self, key: str) -> bool:
        from rospy.params import tree

        return tree().has(key)

    def getParamNames(self) -> list[str]:
        from rospy.params import tree

        return tree().names()

    def setParam(self, key: str, value: Any) -> None:
        from rospy.params import tree

        tree().set(key, value)

    def __getattr__(self, name: str) -> Any:
        raise NotImplementedError("rosgraph.Master.%s: hrdsl has no master; ask rospy for topics, services and parameters" % name)


def _pairs(ports: Any) -> list[list[str]]:
    return [list(pair) for pair in dict.fromkeys((port["name"], port["type"]) for port in ports)]


def _holders(ports: list[dict[str, str]], kind: str) -> list[list[Any]]:
    found: dict[str, list[str]] = {}
    for port in ports:
        if port["kind"] == kind:
            found.setdefault(port["name"], []).append("/" + port["program"])
    return [[name, nodes] for name, nodes in found.items()]
