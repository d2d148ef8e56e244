"""What programs call at their beginning and end; there is no library in C++ that needs it."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Sequence

__all__ = ["roscpp_initialize", "roscpp_shutdown"]


def roscpp_initialize(args: Sequence[str]) -> None:
    """Does nothing."""
    list(args)  # what is no list of words fails as in the original


def roscpp_shutdown() -> None:
    """Does nothing."""
