"""Points and spans of time: whole seconds and nanoseconds, of which the latter are never negative and below a second."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_SECOND = 10**9


def _is_whole(value: Any) -> bool:
    return value.__class__ is int or hasattr(value, "__index__")


def _is_real(value: Any) -> bool:
    return value.__class__ is float or hasattr(value, "__float__") and not isinstance(value, complex)


class TVal:
    """What both have in common."""

    __slots__ = ["secs", "nsecs"]

    _slot_types = ["int32", "int32"]  # as messages have them

    def __init__(self, secs: Any = 0, nsecs: Any = 0) -> None:
        if secs.__class__ is int and nsecs.__class__ is int and 0 <= nsecs < _SECOND:
            self.secs, self.nsecs = secs, nsecs
            return
        if not _is_whole(secs):
            if nsecs != 0:
                raise ValueError("if secs is a float, nsecs cannot be set")
            seconds = secs
            secs = int(seconds)
            nsecs = int((seconds - secs) * 1000000000)
        self.set(int(secs), int(nsecs))
        self.canon()

    @classmethod
    def from_sec(cls, float_secs: float) -> Any:
        """Of so many seconds."""
        secs = int(float_secs)
        return cls(secs, int((float_secs - secs) * 1000000000))

    def is_zero(self) -> bool:
        return self.secs == 0 and self.nsecs == 0

    def set(self, secs: int, nsecs: int) -> None:
        self.secs, self.nsecs = secs, nsecs

    def canon(self) -> None:
        """Brings the nanoseconds below a second."""
        over = self.nsecs // _SECOND
        self.secs += over
        self.nsecs -= over * _SECOND

    def to_sec(self) -> float:
        """In seconds."""
        return float(self.secs) + float(self.nsecs) / 1e9

    def to_nsec(self) -> int:
        """In nanoseconds."""
        return self.secs * _SECOND + self.nsecs

    def __getstate__(self) -> list[int]:
        return [self.secs, self.nsecs]

    def __setstate__(self, state: list[int]) -> None:
        self.secs, self.nsecs = state

    def __hash__(self) -> int:
        return hash((self.secs, self.nsecs))

    def __str__(self) -> str:
        return str(self.to_nsec())

    def __repr__(self) -> str:
        return "genpy.TVal[%d]" % self.to_nsec()

    def __bool__(self) -> bool:
        return self.secs != 0 or self.nsecs != 0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TVal) and self.to_nsec() == other.to_nsec()

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __cmp__(self, other: Any) -> int:
        if not isinstance(other, TVal):
            raise TypeError("Cannot compare to non-TVal")
        mine, its = self.to_nsec(), other.to_nsec()
        return (mine > its) - (mine < its)

    def _compared(self, other: Any) -> Any:
        try:
            return self.__cmp__(other)
        except TypeError:
            return NotImplemented

    def __lt__(self, other: Any) -> Any:
        order = self._compared(other)
        return order if order is NotImplemented else order < 0

    def __le__(self, other: Any) -> Any:
        order = self._compared(other)
        return order if order is NotImplemented else order <= 0

    def __gt__(self, other: Any) -> Any:
        order = self._compared(other)
        return order if order is NotImplemented else order > 0

    def __ge__(self, other: Any) -> Any:
        order = self._compared(other)
        return order if order is NotImplemented else order >= 0


class Time(TVal):
    """A point in time, since 1970."""

    __slots__: list[str] = []

    def __init__(self, secs: Any = 0, nsecs: Any = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            raise TypeError("time values must be positive")

    def to_time(self) -> float:
        """In seconds."""
        return self.to_sec()

    def __repr__(self) -> str:
        return "genpy.Time[%d]" % self.to_nsec()

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return self.__class__(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            return Duration(self.secs - other.secs, self.nsecs - other.nsecs)
        if isinstance(other, Duration):
            return self.__class__(self.secs - other.secs, self.nsecs - other.nsecs)
        return NotImplemented

    def __cmp__(self, other: Any) -> int:
        if not isinstance(other, Time):
            raise TypeError("cannot compare to non-Time")
        return super().__cmp__(other)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Time) and self.secs == other.secs and self.nsecs == other.nsecs

    __hash__ = TVal.__hash__


class Duration(TVal):
    """A span of time, which may be negative."""

    __slots__: list[str] = []

    def __repr__(self) -> str:
        return "genpy.Duration[%d]" % self.to_nsec()

    def __neg__(self) -> Duration:
        return self.__class__(-self.secs, -self.nsecs)

    def __abs__(self) -> Duration:
        return self if self.secs >= 0 else -self

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return self.__class__(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return self.__class__(self.secs - other.secs, self.nsecs - other.nsecs)

    def __mul__(self, factor: Any) -> Any:
        if _is_whole(factor):
            return self.__class__(self.secs * factor, self.nsecs * factor)
        if _is_real(factor):
            return self.__class__.from_sec(self.to_sec() * factor)
        return NotImplemented

    __rmul__ = __mul__

    def __floordiv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return int(self.to_sec() // divisor.to_sec())
        if _is_real(divisor):
            return self.__class__.from_sec(self.to_sec() // divisor)
        return NotImplemented

    def __truediv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return self.to_sec() / divisor.to_sec()
        if _is_real(divisor):
            return self.__class__.from_sec(self.to_sec() / divisor)
        return NotImplemented

    def __mod__(self, divisor: Any) -> Any:
        if not isinstance(divisor, Duration):
            return NotImplemented
        return self.__class__.from_sec(self.to_sec() % divisor.to_sec())

    def __divmod__(self, divisor: Any) -> Any:
        if not isinstance(divisor, Duration):
            return NotImplemented
        quotient, rest = divmod(self.to_sec(), divisor.to_sec())
        return int(quotient), self.__class__.from_sec(rest)

    def __cmp__(self, other: Any) -> int:
        if not isinstance(other, Duration):
            raise TypeError("Cannot compare to non-Duration")
        return super().__cmp__(other)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Duration) and self.secs == other.secs and self.nsecs == other.nsecs

    __hash__ = TVal.__hash__
