"""The classes of `datetime`, with simulated time."""

import copyreg
import functools

from hrdsl.replace import when_imported


def install(now):
    """`now` is the simulated time of day in seconds."""
    # `datetime` takes its names from `_datetime`, where the interpreter has that.
    for name in ("_datetime", "datetime"):
        when_imported(name, lambda module: _replace(module, now))


class LikeReal(type):
    """The C types cannot be patched, so subclasses take their place, as whose instances those of the real types count,
    too. Subclasses made by the program keep the usual meaning."""

    def __instancecheck__(cls, value):
        return isinstance(value, cls._real) if "_real" in cls.__dict__ else super().__instancecheck__(value)

    def __subclasscheck__(cls, other):
        return issubclass(other, cls._real) if "_real" in cls.__dict__ else super().__subclasscheck__(other)


def _replace(module, now):
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


def _date(real, now):
    class date(real, metaclass=LikeReal):
        _real = real

        @classmethod
        def today(cls):
            return cls.fromtimestamp(now())

        def __repr__(self):
            return _with_module(self, super().__repr__())

    return date


def _datetime(real, date, utc, now):
    class datetime(real, metaclass=LikeReal):
        _real = real

        @classmethod
        def now(cls, tz=None):
            return cls.fromtimestamp(now(), tz)

        @classmethod
        def utcnow(cls):
            return cls.now(utc).replace(tzinfo=None)

        @classmethod
        def today(cls):
            return cls.now()

        def date(self):
            return date(self.year, self.month, self.day)

        def __repr__(self):
            return _with_module(self, super().__repr__())

    return datetime


def _with_module(value, text):
    return "datetime." + text if "_real" in type(value).__dict__ else text


def _as(kind, value):
    """How a value made by code in C is pickled: as one of the class in the place of its own."""
    return (kind,) + value.__reduce_ex__(4)[1:]
