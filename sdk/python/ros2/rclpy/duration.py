"""Spans of time."""

from __future__ import annotations

from rclpy.constants import S_TO_NS

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class Duration:
    """A span of time in whole nanoseconds."""

    __slots__ = ("_nanoseconds", "__weakref__")

    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -(2**63) <= total < 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """All of it, in nanoseconds."""
        return self._nanoseconds

    def __repr__(self) -> str:
        return "Duration(nanoseconds=%d)" % self._nanoseconds

    def __str__(self) -> str:
        return "Infinite" if self._nanoseconds == Infinite._nanoseconds else "%d nanoseconds" % self._nanoseconds

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds == other._nanoseconds
        raise TypeError("Can't compare duration with object of type: ", type(other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __lt__(self, other: Any) -> bool:
        return self._nanoseconds < other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __le__(self, other: Any) -> bool:
        return self._nanoseconds <= other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __gt__(self, other: Any) -> bool:
        return self._nanoseconds > other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __ge__(self, other: Any) -> bool:
        return self._nanoseconds >= other._nanoseconds if isinstance(other, Duration) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def to_msg(self) -> Any:
        """The same as a `builtin_interfaces.msg.Duration`."""
        from builtin_interfaces.msg import Duration as Made

        seconds, nanoseconds = divmod(self._nanoseconds, S_TO_NS)
        return Made(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> Duration:
        """The same as a message tells it."""
        from builtin_interfaces.msg import Duration as Expected

        if not isinstance(msg, Expected):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


#: Longer than anything.
Infinite = Duration(nanoseconds=2**63 - 1)
