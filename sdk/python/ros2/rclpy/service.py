"""Services."""

from __future__ import annotations

from collections import deque

from rclpy import _world
from rclpy.task import is_coroutine_function
from rclpy.type_support import decoded, name_of

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class Service:
    """Answers requests with what a callback makes of them."""

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        full_name: str,
        callback: Callable[..., Any],
        callback_group: Any,
        qos_profile: Any,
    ) -> None:
        type_name = name_of(srv_type, "Service")
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self._executor_event = False
        self._is_destroyed = False
        self._full_name = full_name
        self._type_name = type_name
        self._wake: Callable[[], None] = node._wake_executor
        self._waiting: deque[tuple[int, Any]] = deque()
        self._port = _world.open_port("server", full_name, type_name, self._arrived)

    def _arrived(self, arrival: dict[str, Any]) -> None:
        if "called" in arrival:
            self._waiting.append((arrival["called"], arrival["message"]))
            self._wake()

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting)

    def _is_async(self) -> bool:
        return is_coroutine_function(self.callback)

    def _take(self) -> tuple[Any, tuple[Any, ...]] | None:
        if not self._waiting:
            return None
        number, value = self._waiting.popleft()
        what = "service %s (%s)" % (self._full_name, self._type_name)
        request = decoded(self.srv_type.Request._codec_, value, what)
        return (self._serve_async if self._is_async() else self._serve), (request, number)

    def _serve(self, request: Any, number: int) -> None:
        self.send_response(self.callback(request, self.srv_type.Response()), number)

    async def _serve_async(self, request: Any, number: int) -> None:
        self.send_response(await self.callback(request, self.srv_type.Response()), number)

    def send_response(self, response: Any, header: Any) -> None:
        """Answers a request."""
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(
                "service %s: the callback has to return a %s, and has returned a %s"
                % (self._full_name, self.srv_type.Response.__name__, type(response).__name__)
            )
        _world.exchange().respond(header, response._codec_.encode(response).encode("ascii"))

    @property
    def service_name(self) -> str:
        """The full name of the service."""
        return self._full_name

    def destroy(self) -> None:
        """Answers no more."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._waiting.clear()
            _world.close(self._port)
