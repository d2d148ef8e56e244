"""The exceptions that robot code can meet."""


class Stopped(SystemExit):
    """The test is over: the program should end.

    It is a `SystemExit`, so that `except Exception` does not swallow it and an uncaught one prints no traceback.
    """

    def __init__(self, why="the test is over"):
        super().__init__(0)
        self.why = why

    def __str__(self):
        return self.why


class ProtocolError(RuntimeError):
    """The harness refused a request: an event, signal or device that the scenario does not declare, or bad arguments."""

    def __init__(self, message, help=None):
        super().__init__(message if not help else "%s (%s)" % (message, help))
        self.message = message
        self.help = help
