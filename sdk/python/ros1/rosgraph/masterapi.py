"""The master, as far as it tells what is there."""

from __future__ import annotations

import errno
import os

from rosgraph.names import make_caller_id, resolve_name
from rosgraph.rosenv import get_master_uri

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class MasterException(Exception):
    """The base of what goes wrong with the master."""


class MasterFailure(MasterException):
    """The master could not do it."""


class MasterError(MasterException):
    """The master was asked for something that there is not."""


ROSMasterException = MasterException
Error = MasterError
Failure = MasterFailure


def is_online(master_uri: str | None = None) -> bool:
    """Whether the master is there: that of the test always is, and no other."""
    return Master("rosgraph", master_uri).is_online()


class Master:
    """Asks what is open in the system."""

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.master_uri = get_master_uri() if master_uri is None else master_uri
        self._is_here = _place(self.master_uri) == _place(get_master_uri())
        self.caller_id = make_caller_id(caller_id)[:-1]

    def is_online(self) -> bool:
        return self._is_here

    def _reach(self) -> None:
        if not self._is_here:
            raise ConnectionRefusedError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED))

    def _ports(self) -> list[dict[str, str]]:
        from hrdsl.exchange import the_exchange

        self._reach()
        ports: list[dict[str, str]] = the_exchange().listing()
        return ports

    def getPid(self) -> int:
        self._reach()
        return 1

    def getUri(self) -> str:
        self._reach()
        return self.master_uri

    def getPublishedTopics(self, subgraph: str) -> list[list[str]]:
        """Pairs of names and types, of the topics in a namespace."""
        within = resolve_name(subgraph, self.caller_id) if subgraph else "/"
        within = within if within.endswith("/") else within + "/"
        return _pairs(port for port in self._ports() if port["kind"] == "publisher" and port["name"].startswith(within))

    def getTopicTypes(self) -> list[list[str]]:
        """Pairs of names and types."""
        return _pairs(port for port in self._ports() if port["kind"] in ("publisher", "subscriber"))

    def getSystemState(self) -> list[Any]:
        """Publishers, subscribers and services, each with the names of their nodes."""
        ports = self._ports()
        return [_holders(ports, kind) for kind in ("publisher", "subscriber", "server")]

    def lookupService(self, service: str) -> str:
        if not service:
            raise MasterError("ERROR: parameter [service] must be a non-empty string")
        name = resolve_name(service, self.caller_id)
        for port in self._ports():
            if port["kind"] == "server" and port["name"] == name:
                return "rosrpc://localhost:1"
        raise MasterError("no provider")

    def getParam(self, key: str) -> Any:
        name = self._parameter(key)
        try:
            return _tree().get(name)
        except KeyError:
            raise MasterError("Parameter [%s] is not set" % name) from None

    def hasParam(self, key: str) -> bool:
        found: bool = _tree().has(self._parameter(key))
        return found

    def getParamNames(self) -> list[str]:
        self._reach()
        found: list[str] = _tree().names()
        return found

    def searchParam(self, key: str) -> str:
        """The name of the nearest one, in the namespaces from that of the caller upwards."""
        self._reach()
        found: str | None = _tree().search(self.caller_id, key)
        if found is None:
            raise MasterError("Cannot find parameter [%s] in an upwards search" % key)
        return found

    def setParam(self, key: str, value: Any) -> int:
        _tree().set(self._parameter(key), value)
        return 0

    def deleteParam(self, key: str) -> int:
        name = self._parameter(key)
        try:
            _tree().delete(name)
        except KeyError:
            raise MasterError("parameter [%s] is not set" % name) from None
        return 0

    def _parameter(self, key: str) -> str:
        self._reach()
        return resolve_name(key, self.caller_id)

    def __getattr__(self, name: str) -> Any:
        raise NotImplementedError("rosgraph.Master.%s: hrdsl has no master; ask rospy for topics, services and parameters" % name)


def _tree() -> Any:
    from rospy.params import tree

    return tree()


def _place(uri: str) -> tuple[str, int]:
    """Host and port."""
    from urllib.parse import urlsplit

    parts = urlsplit(uri)
    if not parts.scheme or not parts.hostname:
        raise ValueError("invalid master URI: %s" % uri)
    return "localhost" if parts.hostname in ("127.0.0.1", "::1") else parts.hostname, parts.port or 80


def _pairs(ports: Any) -> list[list[str]]:
    return [list(pair) for pair in dict.fromkeys((port["name"], port["type"]) for port in ports)]


def _holders(ports: list[dict[str, str]], kind: str) -> list[list[Any]]:
    found: dict[str, list[str]] = {}
    for port in ports:
        if port["kind"] == kind:
            found.setdefault(port["name"], []).append("/" + port["program"])
    return [[name, nodes] for name, nodes in found.items()]
