"""The base of errors of this package."""


class ROSLibException(Exception):
    """The base."""
