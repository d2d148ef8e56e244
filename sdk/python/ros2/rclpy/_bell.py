"""What threads of rclpy wait with."""

from __future__ import annotations

from rclpy import _world

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class Bell:
    """Wakes those who wait for it to ring, now or later."""

    __slots__ = ("is_rung", "_sleepers")

    def __init__(self) -> None:
        self.is_rung = False
        self._sleepers: list[Any] = []

    def ring(self) -> None:
        """Wakes all who wait; never waits."""
        self.is_rung = True
        if self._sleepers:
            unpark = _world.exchange().scheduler.unpark
            for sleeper in self._sleepers:
                if sleeper is not None:
                    unpark(sleeper)

    def wait(self, deadline: int | None = None, is_patient: bool = True) -> bool:
        """Waits until it rings, or has rung, or until the deadline (simulated nanoseconds): whether it has rung. Who is
        patient still hears it at the very instant of the deadline."""
        exchange = _world.exchange()
        me = exchange.scheduler.current()
        park = exchange.park if is_patient or me is None else exchange.scheduler.park
        self._sleepers.append(me)
        try:
            while not self.is_rung:
                if not park(self, deadline):
                    break
        finally:
            self._sleepers.remove(me)
        return self.is_rung
