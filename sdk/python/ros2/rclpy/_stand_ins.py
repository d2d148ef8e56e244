"""Modules of ROS 2 that are not there, and that programs import for what they do elsewhere: a file of nodes may have a launch
description, too. They can be imported; who calls what is in them is refused."""

from __future__ import annotations

import sys
from types import ModuleType

from rclpy import _world

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class _StandIn(ModuleType):
    """A module that has every name."""

    _instead: str

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError("module %r has no attribute %r" % (self.__name__, name))
        return _Name("%s.%s" % (self.__name__, name), self._instead)


class _Name:
    """What a program finds there: a class, a function or a module."""

    def __init__(self, name: str, instead: str) -> None:
        self._name, self._instead = name, instead

    def __repr__(self) -> str:
        return "<%s, which is refused>" % self._name

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError("%r has no attribute %r" % (self, name))
        return _Name("%s.%s" % (self._name, name), self._instead)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        _world.unsupported(self._name, self._instead)

    def __mro_entries__(self, bases: Any) -> tuple[type, ...]:
        """A class of the program's own that is made from it is refused when it is called."""
        name, instead = self._name, self._instead

        class Refused:
            def __new__(cls, *args: Any, **kwargs: Any) -> Any:
                _world.unsupported(name, instead)

        return (Refused,)


def install(package: str, instead: str, modules: tuple[str, ...]) -> None:
    """Makes a package that is being imported one of them, and all modules that are in it."""
    for name in (package, *(package + "." + module for module in modules)):
        made = sys.modules.setdefault(name, ModuleType(name))
        made.__class__ = _StandIn
        made._instead = instead  # type: ignore[attr-defined]
        made.__path__ = []
        parent, _, own = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], own, made)
