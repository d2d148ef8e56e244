"""Services, and those who call them. Each call is handled in a thread of its own."""

from __future__ import annotations

import sys
import threading
import time

import genpy
from hrdsl.errors import Deadlock, ProtocolError, Stopped
from hrdsl.exchange import the_exchange
from hrdsl.interfaces import class_of
from hrdsl.mailbox import Mailbox
from rosgraph.names import is_legal_name
from rospy import core
from rospy.exceptions import ROSException, ROSInterruptException
from rospy.graph import graph
from rospy.header import ConnectionHeader
from rospy.log import logerr
from rospy.msg import args_kwds_to_message
from rospy.names import get_caller_id, resolve_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

DEFAULT_BUFF_SIZE = 65536

_services: dict[str, ServiceImpl] = {}


class ServiceException(Exception):
    """A call of a service has failed."""


class _Service:
    """What both sides have in common."""

    def __init__(self, name: str, service_class: Any) -> None:
        self.resolved_name = resolve_name(name)
        self.service_class = service_class
        self.request_class = service_class._request_class
        self.response_class = service_class._response_class
        self.uri: str | None = None

    def _header(self, other: str) -> ConnectionHeader:
        cls = self.service_class
        return ConnectionHeader(other, self.resolved_name, service=self.resolved_name, type=cls._type, md5sum=cls._md5sum)


def wait_for_service(service: str, timeout: Any = None) -> None:
    """Waits until there is such a service; raises `ROSException` after the timeout (seconds, or a `Duration`)."""
    _wait_for(service, timeout, None)


def _wait_for(service: str, timeout: Any, type_name: str | None) -> None:
    if isinstance(timeout, genpy.Duration):
        timeout = timeout.to_sec()
    if timeout == 0.0:
        raise ValueError("timeout must be non-zero")
    name = resolve_name(service)
    deadline = the_exchange().time + round(timeout * 1e9) if timeout else None
    the_exchange().awaits("client", name, type_name, deadline)
    there = graph.wait(lambda: core.is_shutdown() or graph.programs("server", name), deadline)
    if core.is_shutdown():
        raise ROSInterruptException("rospy shutdown")
    if not there:
        raise ROSException("timeout exceeded while waiting for service %s" % name)


class ServiceProxy(_Service):
    """Calls a service."""

    def __init__(self, name: str, service_class: Any, persistent: bool = False, headers: dict[str, str] | None = None) -> None:
        super().__init__(name, service_class)
        self.seq = 0
        self.buff_size = DEFAULT_BUFF_SIZE
        self.persistent = persistent
        self._port: Any = None
        self._closed = False

    def wait_for_service(self, timeout: Any = None) -> None:
        """Waits until the service is there."""
        _wait_for(self.resolved_name, timeout, self.service_class._type)

    def __call__(self, *args: Any, **kwds: Any) -> Any:
        return self.call(*args, **kwds)

    def call(self, *args: Any, **kwds: Any) -> Any:
        """The response to a request, which is given as a message, or by the values of its fields."""
        request = args_kwds_to_message(self.request_class, args, kwds)
        if request._type != self.request_class._type:
            told = request.__class__, self.request_class
            raise TypeError("request object type [%s] does not match service type [%s]" % told)
        if self._port is None:
            self._port = self._open()
        box = Mailbox()
        self.seq += 1
        self._port.call(self.request_class._json(request).encode("ascii"), box.put)
        answer = box.get()
        if "error" in answer:
            raise ServiceException(self._fault(answer["error"]))
        response = self.response_class._of_json(answer["message"])
        response._connection_header = self._header("server")
        return response

    def _open(self) -> Any:
        try:
            return the_exchange().open("client", self.resolved_name, self.service_class._type)
        except ProtocolError as error:
            types = {port["type"] for port in graph.ports() if port["kind"] == "server" and port["name"] == self.resolved_name}
            if len(types) != 1 or self.service_class._type in types:
                raise
            sums = get_caller_id(), self.service_class._md5sum, class_of(*types)._md5sum
            told = "unable to connect to service: remote error reported: request from [%s]: md5sums do not match: [%s] vs. [%s]"
            raise ServiceException(told % sums) from error

    def _fault(self, error: str) -> str:
        if error.endswith("has no server"):
            return "service [%s] unavailable" % self.resolved_name
        return "service [%s] responded with an error: %s" % (self.resolved_name, error.encode("utf-8"))

    def close(self) -> None:
        """Ends the connection, which the next call makes again."""
        port, self._port = self._port, None
        if port is not None:
            port.close()


class ServiceImpl(_Service):
    """A service, whose handler answers requests."""

    def __init__(
        self,
        name: str,
        service_class: Any,
        handler: Callable[[Any], Any],
        buff_size: int = DEFAULT_BUFF_SIZE,
        error_handler: Callable[..., Any] | None = None,
    ) -> None:
        super().__init__(name, service_class)
        if not name or not isinstance(name, str):
            raise ValueError("service name is not a non-empty string")
        if not is_legal_name(name):
            import warnings

            text = "'%s' is not a legal ROS graph resource name. This may cause problems with other ROS tools"
            warnings.warn(text % name, stacklevel=2)
        self.handler = handler
        if error_handler is not None:
            self.error_handler = error_handler  # type: ignore[method-assign]
        self.seq = 0
        self.done = False
        self.buff_size = buff_size
        self.uri = "rosrpc://localhost:1"
        self._box = Mailbox()
        self._port: Any = None

    def error_handler(self, e: Any, exc_type: Any, exc_value: Any, tb: Any) -> None:
        """What becomes of an exception of the handler."""
        import traceback

        logerr("Error processing request: %s\n%s" % (e, traceback.format_exception(exc_type, exc_value, tb)))

    def start(self) -> None:
        """Begins to serve, once there is a node."""
        if self.resolved_name in _services:
            raise ServiceException("service [%s] already registered" % self.resolved_name)
        _services[self.resolved_name] = self
        core.when_initialized(self._open)

    def _open(self) -> None:
        if not self.done:
            self._port = the_exchange().open("server", self.resolved_name, self.service_class._type, handler=self._box.put)
            graph.forget()
            threading.Thread(target=self._serve, name=self.resolved_name, daemon=True).start()

    def _serve(self) -> None:
        while True:
            arrival = self._box.get()
            if arrival is None:
                return
            threading.Thread(target=self._handle, args=(arrival,), name=self.resolved_name, daemon=True).start()

    def _handle(self, arrival: Any) -> None:
        exchange, number = the_exchange(), arrival["called"]
        try:
            request = self.request_class._of_json(arrival["message"])
            request._connection_header = self._header("client")
            response = convert_return_to_response(self.handler(request), self.response_class)
            self.seq += 1
            answer = self.response_class._json(response).encode("ascii")
        except (Stopped, Deadlock):
            raise
        except ServiceException as error:
            exchange.refuse(number, "service cannot process request: %s" % error)
        except Exception as error:
            self.error_handler(error, *sys.exc_info())
            exchange.refuse(number, "error processing request: %s" % error)
        else:
            exchange.respond(number, answer)

    def shutdown(self, reason: str = "") -> None:
        """Serves no more."""
        self.done = True
        if _services.get(self.resolved_name) is self:
            del _services[self.resolved_name]
        port, self._port = self._port, None
        if port is not None:
            port.close()
            graph.forget()
            self._box.put(None)

    def spin(self) -> None:
        """Waits until the service or the node has ended."""
        try:
            while not core.is_shutdown() and not self.done:
                time.sleep(0.5)
        except KeyboardInterrupt:
            pass


class Service(ServiceImpl):
    """A service, whose handler answers requests: with a response, or with the values of its fields."""

    def __init__(
        self,
        name: str,
        service_class: Any,
        handler: Callable[[Any], Any],
        buff_size: int = DEFAULT_BUFF_SIZE,
        error_handler: Callable[..., Any] | None = None,
    ) -> None:
        super().__init__(name, service_class, handler, buff_size, error_handler)
        self.start()


def convert_return_to_response(response: Any, response_class: Any) -> Any:
    """The response that a handler means by what it returns."""
    if isinstance(response, genpy.Message) and response._type == response_class._type:
        return response
    if type(response) is dict:
        try:
            return response_class(**response)
        except AttributeError as error:
            raise ServiceException("handler returned invalid value: %s" % error) from error
    if response is None:
        raise ServiceException("service handler returned None")
    is_list = type(response) in (list, tuple)
    try:
        return response_class(*response) if is_list else response_class(response)
    except TypeError as error:
        what = "wrong number of values" if is_list else "invalid value"
        raise ServiceException("handler returned %s: %s" % (what, error)) from error
