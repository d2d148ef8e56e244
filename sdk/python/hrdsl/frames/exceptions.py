"""Why it is not known where a frame was."""


class TransformException(Exception):
    """Base of the others."""


class ConnectivityException(TransformException):
    """The frames belong to different trees."""


class LookupException(TransformException):
    """Nothing was heard of a frame."""


class ExtrapolationException(TransformException):
    """It was heard where the frame was at other times."""


class InvalidArgumentException(TransformException):
    """No name of a frame."""


class TimeoutException(TransformException):
    """It was not known in time."""
