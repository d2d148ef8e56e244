"""Where one frame was in its parent, at some times or always."""

from __future__ import annotations

from bisect import bisect_left

from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Kept = tuple[str, tuple[float, ...], tuple[float, ...]]

OLD = "TF_OLD_DATA ignoring data from the past (Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained)"
REPEATED = "TF_REPEATED_DATA ignoring data with redundant timestamp"


class Missing(Exception):
    """Nothing is known of the time; the text says why."""


class TimeCache:
    """Places (parent, translation, rotation) by their times, in nanoseconds."""

    def __init__(self, longest: int) -> None:
        self._longest = longest
        self._stamps: list[int] = []
        self._kept: list[Kept] = []

    def insert(self, stamp: int, place: Kept) -> str:
        """Keeps a place; why not, if not."""
        stamps = self._stamps
        at = len(stamps)
        if stamps and stamp <= stamps[-1]:
            if stamp + self._longest < stamps[-1]:
                return OLD
            at = bisect_left(stamps, stamp)
            if stamps[at] == stamp:
                return REPEATED
        stamps.insert(at, stamp)
        self._kept.insert(at, place)
        gone = 0
        while stamps[gone] + self._longest < stamps[-1]:
            gone += 1
        if gone:
            del stamps[:gone], self._kept[:gone]
        return ""

    def get(self, stamp: int) -> Kept:
        """The place at a time (0: the latest), between two that are kept if need be."""
        stamps = self._stamps
        if not stamps:
            raise Missing("")
        if stamp == 0:
            return self._kept[-1]
        at = bisect_left(stamps, stamp)
        if at < len(stamps) and stamps[at] == stamp:
            return self._kept[at]
        if len(stamps) == 1:
            text = "Lookup would require extrapolation at time %.9f, but only time %.9f is in the buffer"
            raise Missing(text % (stamp / 1e9, stamps[0] / 1e9))
        if at == len(stamps):
            text = (
                "Lookup would require extrapolation %.9fs into the future.  Requested time %.9f but the latest data is at"
                " time %.9f"
            )
            raise Missing(text % ((stamp - stamps[-1]) / 1e9, stamp / 1e9, stamps[-1] / 1e9))
        if at == 0:
            text = (
                "Lookup would require extrapolation %.9fs into the past.  Requested time %.9f but the earliest data is at"
                " time %.9f"
            )
            raise Missing(text % ((stamps[0] - stamp) / 1e9, stamp / 1e9, stamps[0] / 1e9))
        before, after = self._kept[at - 1], self._kept[at]
        if before[0] != after[0]:
            return before
        part = (stamp - stamps[at - 1]) / (stamps[at] - stamps[at - 1])
        moved = tuple((1.0 - part) * a + part * b for a, b in zip(before[1], after[1]))
        return before[0], moved, rigid.slerp(before[2], after[2], part)

    def latest(self) -> tuple[int, str | None]:
        """The last time, and the parent then."""
        return (self._stamps[-1], self._kept[-1][0]) if self._stamps else (0, None)

    def oldest(self) -> int:
        """The first time."""
        return self._stamps[0] if self._stamps else 0

    def clear(self) -> None:
        """Forgets all."""
        self._stamps.clear()
        self._kept.clear()

    def __len__(self) -> int:
        return len(self._stamps)


class StaticCache:
    """One place, at all times."""

    def __init__(self) -> None:
        self._kept: Kept | None = None

    def insert(self, stamp: int, place: Kept) -> str:
        """Keeps a place instead of the one before."""
        self._kept = place
        return ""

    def get(self, stamp: int) -> Kept:
        """The place."""
        if self._kept is None:
            raise Missing("")
        return self._kept

    def latest(self) -> tuple[int, str | None]:
        """No time, and the parent."""
        return 0, self._kept and self._kept[0]

    def oldest(self) -> int:
        """No time."""
        return 0

    def clear(self) -> None:
        """Keeps it: what is static stays."""

    def __len__(self) -> int:
        return 1


def make(is_static: bool, longest: int) -> Any:
    """For a frame that is new."""
    return StaticCache() if is_static else TimeCache(longest)
