"""The classes of `datetime`, with simulated time."""

from __future__ import annotations

import copyreg
import functools

from hrdsl.replace import when_imported

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable


def install(now: Callable[[], float]) -> None:
    """`now` is the simulated time of day in seconds."""
    # `datetime` takes its names from `_datetime`, where the interpreter has that.
    for name in ("_datetime", "datetime"):
        when_imported(name, lambda module: _replace(module, now))


class LikeReal(type):
    """The C types cannot be patched, so subclasses take their place, as whose instances those of the real types count,
    too. Subclasses made by the program keep the usual meaning."""

    _real: Any

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, cls._real) if "_real" in cls.__dict__ else super().__instancecheck__(value)

    def __subclasscheck__(cls, other: type) -> bool:
        return issubclass(other, cls._real) if "_real" in cls.__dict__ else super().__subclasscheck__(other)


def _replace(module: Any, now: Callable[[], float]) -> None:
    if isinstance(module.date, LikeReal):
        return
    date = _date(module.date, now)
    datetime = _datetime(module.datetime, date, module.timezone.utc, now)
    for kind in (date, datetime):
        real = kind._real
        kind.__module__, kind.__qualname__, kind.__doc__ = "datetime", kind.__name__, real.__doc__
        kind.min, kind.max = (kind(*value.__reduce__()[1]) for value in (real.min, real.max))
        copyreg.pickle(real, functools.partial(_as, kind))
        setattr(module, kind.__name__, kind)


def _date(real: Any, now: Callable[[], float]) -> Any:
    class date(real, metaclass=LikeReal):  # type: ignore[misc]
        _real = real

        @classmethod
        def today(cls) -> Any:
            return cls.fromtimestamp(now())

        def __repr__(self) -> str:
            return _with_module(self, super().__repr__())

    return date


def _datetime(real: Any, date: Any, utc: Any, now: Callable[[], float]) -> Any:
    class datetime(real, metaclass=LikeReal):  # type: ignore[misc]
        _real = real

        @classmethod
        def now(cls, tz: Any = None) -> Any:
            return cls.fromtimestamp(now(), tz)

        @classmethod
        def utcnow(cls) -> Any:
            return cls.now(utc).replace(tzinfo=None)

        @classmethod
        def today(cls) -> Any:
            return cls.now()

        def date(self) -> Any:
            return date(self.year, self.month, self.day)

        def __repr__(self) -> str:
            return _with_module(self, super().__repr__())

    return datetime


def _with_module(value: object, text: str) -> str:
    return "datetime." + text if "_real" in type(value).__dict__ else text


def _as(kind: Any, value: Any) -> Any:
    """How a value made by code in C is pickled: as one of the class in the place of its own."""
    return (kind,) + value.__reduce_ex__(4)[1:]
