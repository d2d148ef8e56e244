"""The server that a viewer of machines asks. Here, nobody watches: it gives the machine its name, and that is all."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

__all__ = ["IntrospectionClient", "IntrospectionServer"]


class IntrospectionServer:
    """Names the container by its path, as hrdsl tells it."""

    def __init__(self, server_name: str, state: Any, path: str) -> None:
        self._proxies: list[Any] = []
        self._server_name = server_name
        self._state = state
        self._path = path
        name = path.strip("/") or server_name.strip("/")
        if name and hasattr(state, "_told_name") and state._told_name is None:
            state._told_name = name

    def start(self) -> None:
        """Begins to answer nobody."""

    def stop(self) -> None:
        """Ends that."""

    def clear(self) -> None:
        """There is nothing to forget."""


class IntrospectionClient:
    """Refused."""

    def __init__(self) -> None:
        raise NotImplementedError(
            "smach_ros.IntrospectionClient is not there in hrdsl: set the initial state of a machine by its own set_initial_state"
        )

    def get_servers(self) -> NoReturn:
        """Refused."""
        raise NotImplementedError
