"""Clients of services."""

from __future__ import annotations

import sys
import threading
import time
from collections import deque

from rclpy import _world
from rclpy._rclpy_pybind11 import InvalidHandle
from rclpy.task import Future
from rclpy.type_support import decoded, name_of

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class Client:
    """Asks a service."""

    def __init__(
        self, node: Any, srv_type: Any, srv_name: str, full_name: str, qos_profile: Any, callback_group: Any
    ) -> None:
        type_name = name_of(srv_type, "Service")
        self.context = node.context
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.qos_profile = qos_profile
        self.callback_group = callback_group
        self._executor_event = False
        self._is_destroyed = False
        self._node = node
        self._full_name = full_name
        self._type_name = type_name
        self._pending_requests: dict[int, Future] = {}
        self._waiting: deque[tuple[int, dict[str, Any]]] = deque()
        self._sequence = 0
        self._port = _world.open_port("client", full_name, type_name)

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Asks, and waits for the response, while another thread spins the node; None if the timeout passes before."""
        event = threading.Event()
        future = self.call_async(request)
        future.add_done_callback(lambda _: event.set())
        if not future._done and not event.wait(timeout_sec):
            self.remove_pending_request(future)
        if future.exception() is not None:
            raise future.exception()  # type: ignore[misc]
        return future.result()

    def call_async(self, request: Any) -> Future:
        """Asks; the future is done when the response has come."""
        if not isinstance(request, self.srv_type.Request):
            raise TypeError()
        if self._is_destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        self._sequence += 1
        number = self._sequence

        def arrived(arrival: dict[str, Any]) -> None:
            self._waiting.append((number, arrival))
            self._node._wake_executor()

        self._port.call(request._codec_.encode(request).encode("ascii"), arrived)
        future = Future()
        self._pending_requests[number] = future
        future.add_done_callback(self.remove_pending_request)
        return future

    def get_pending_request(self, sequence_number: int) -> Future:
        """The future of a request; raises KeyError if it is not waited for."""
        return self._pending_requests[sequence_number]

    def remove_pending_request(self, future: Future) -> None:
        """It is waited for no more."""
        for number, pending in self._pending_requests.items():
            if pending is future:
                del self._pending_requests[number]
                break

    def _is_ready(self, now: int) -> bool:
        return bool(self._waiting)

    def _is_async(self) -> bool:
        return False

    def _take(self) -> tuple[Any, tuple[Any, ...]] | None:
        return (self._finish, self._waiting.popleft()) if self._waiting else None

    def _finish(self, number: int, arrival: dict[str, Any]) -> None:
        future = self._pending_requests.get(number)
        if future is None:
            return
        if "error" in arrival:  # on a robot nothing would come
            told = "hrdsl: service %s (%s): a request of %s is never answered: %s\n"
            sys.stderr.write(told % (self._full_name, self._type_name, self._node.get_name(), arrival["error"]))
            return
        what = "service %s (%s)" % (self._full_name, self._type_name)
        response = decoded(self.srv_type.Response._codec_, arrival["message"], what)
        future._set_executor(self._node.executor)
        future.set_result(response)

    @property
    def service_name(self) -> str:
        """The full name of the service."""
        return self._full_name

    def service_is_ready(self) -> bool:
        """Whether there is a server."""
        return _world.count("server", self._full_name) > 0

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Looks every quarter of a second whether there is a server, until the timeout: whether there is."""
        left = float("inf") if timeout_sec is None else timeout_sec
        is_told = False
        while self.context.is_open() and not self.service_is_ready() and left > 0.0:
            if not is_told:
                is_told = True
                _world.awaits("client", self._full_name, self._type_name, left)
            time.sleep(0.25)
            left -= 0.25
        return self.service_is_ready()

    def destroy(self) -> None:
        """Asks no more."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._waiting.clear()
            _world.close(self._port)
