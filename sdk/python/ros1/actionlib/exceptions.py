"""What is wrong with the use of an action."""


class ActionException(Exception):
    """A type that is no action."""
