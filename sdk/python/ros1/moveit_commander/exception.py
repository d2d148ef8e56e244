"""What goes wrong with plans and motions."""

__all__ = ["MoveItCommanderException"]


class MoveItCommanderException(Exception):
    """A target, a name or a value that does not fit."""
