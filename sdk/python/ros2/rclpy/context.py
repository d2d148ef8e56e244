"""What lies between `rclpy.init` and `rclpy.shutdown`."""

from __future__ import annotations

import sys
from types import MethodType
from weakref import WeakMethod

from rclpy import _world
from rclpy._arguments import Arguments
from rclpy._bell import Bell
from rclpy._rclpy_pybind11 import RCLError
from rclpy.impl import rcutils_logger

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


class Context:
    """A span in which nodes can live."""

    def __init__(self) -> None:
        self._arguments: Arguments | None = None  # None before `init`
        self._is_shut_down = False
        self._callbacks: list[Any] = []
        self._domain_id = 0

    def init(
        self, args: list[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Begins it, with the arguments of the command line."""
        if domain_id is not None and domain_id < 0:
            raise RuntimeError("Domain id (%d) should not be lower than zero." % domain_id)
        if self._arguments is not None:
            raise RuntimeError("Context.init() must only be called once")
        arguments = Arguments(sys.argv if args is None else args)
        _world.exchange()  # there has to be a harness
        self._arguments = arguments
        self._domain_id = domain_id or 0
        if initialize_logging:
            for name, level in arguments.levels:
                rcutils_logger.set_level(name, level)
            rcutils_logger.silence(arguments.is_silent)
        for rule in arguments.deprecated:
            text = "Found remap rule '%s'. This syntax is deprecated. Use '--ros-args --remap %s' instead."
            rcutils_logger.RcutilsLogger("rcl").warning(text % (rule, rule))

    @property
    def arguments(self) -> Arguments:
        """What `init` was given; raises RuntimeError before."""
        if self._arguments is None:
            raise RuntimeError("the context is not initialized")
        return self._arguments

    def ok(self) -> bool:
        """Whether it has begun and not ended."""
        if self._arguments is not None:
            _world.looked("rclpy.ok")
        return self.is_open()

    def is_open(self) -> bool:
        """The same, asked by rclpy itself, for which it is no poll."""
        return self._arguments is not None and not self._is_shut_down

    def shutdown(self) -> None:
        """Ends it."""
        if self._arguments is None:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if self._is_shut_down:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self._end()

    def try_shutdown(self) -> None:
        """Ends it, if it has not ended."""
        if self.is_open():
            self._end()

    def _end(self) -> None:
        self._is_shut_down = True
        callbacks, self._callbacks = self._callbacks, []
        for each in callbacks:
            callback = each() if isinstance(each, WeakMethod) else each
            if callback is not None:
                callback()

    def destroy(self) -> None:
        """There is nothing to free."""

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        """Calls it when the context ends; at once if it has ended."""
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        if self._is_shut_down:
            callback()
        elif isinstance(callback, MethodType):
            self._callbacks.append(WeakMethod(callback, self._forget))
        else:
            self._callbacks.append(callback)

    def _forget(self, method: Any) -> None:
        if method in self._callbacks:
            self._callbacks.remove(method)

    def get_domain_id(self) -> int:
        """The number that keeps systems apart; it does nothing here."""
        if self._arguments is None:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self._domain_id

    def _wait(self, until: int | None, bell: Bell | None = None) -> None:
        """Waits until then (simulated nanoseconds), or until the bell rings or the context ends."""
        is_patient, bell = bell is not None, bell or Bell()
        ring = bell.ring
        self._callbacks.append(ring)
        try:
            bell.wait(until, is_patient)
        finally:
            if ring in self._callbacks:
                self._callbacks.remove(ring)

    def __enter__(self) -> Context:
        self.init()
        return self

    def __exit__(self, *of_exception: object) -> None:
        self.try_shutdown()
