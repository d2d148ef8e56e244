"""Points in time."""

from __future__ import annotations

from rclpy.clock_type import ClockType
from rclpy.duration import Duration

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

CONVERSION_CONSTANT = 10**9


class Time:
    """A point in time of one kind of clock, in whole nanoseconds."""

    __slots__ = ("_nanoseconds", "_clock_type", "__weakref__")

    def __init__(
        self, *, seconds: float = 0, nanoseconds: int = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * CONVERSION_CONSTANT) + int(nanoseconds)
        if total >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Since the clock's zero."""
        return self._nanoseconds

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """The same in two parts."""
        return divmod(self._nanoseconds, CONVERSION_CONSTANT)

    @property
    def clock_type(self) -> ClockType:
        """Which clock it is of."""
        return self._clock_type

    def __repr__(self) -> str:
        return "Time(nanoseconds=%d, clock_type=%s)" % (self._nanoseconds, self._clock_type.name)

    def _at(self, nanoseconds: int) -> Time:
        return Time(nanoseconds=nanoseconds, clock_type=self._clock_type)

    def __add__(self, other: Any) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return self._at(self._nanoseconds + other.nanoseconds)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            if self._clock_type != other._clock_type:
                raise TypeError("Can't subtract times with different clock types")
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return self._at(self._nanoseconds - other.nanoseconds)
        except ValueError as error:
            raise ValueError("Subtraction leads to negative time.") from error

    def _check(self, other: Time) -> None:
        if self._clock_type != other._clock_type:
            raise TypeError("Can't compare times with different clock types")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Time):
            raise TypeError("Can't compare time with object of type: ", type(other))
        self._check(other)
        return self._nanoseconds == other._nanoseconds

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __lt__(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._check(other)
        return self._nanoseconds < other._nanoseconds

    def __le__(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._check(other)
        return self._nanoseconds <= other._nanoseconds

    def __gt__(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._check(other)
        return self._nanoseconds > other._nanoseconds

    def __ge__(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._check(other)
        return self._nanoseconds >= other._nanoseconds

    __hash__ = None  # type: ignore[assignment]

    def to_msg(self) -> Any:
        """The same as a `builtin_interfaces.msg.Time`."""
        from builtin_interfaces.msg import Time as Made

        seconds, nanoseconds = self.seconds_nanoseconds()
        return Made(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """The same as a message tells it."""
        from builtin_interfaces.msg import Time as Expected

        if not isinstance(msg, Expected):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)
