"""The exceptions that robot code can meet."""

from __future__ import annotations


class Stopped(SystemExit):
    """The test is over: the program should end.

    It is a `SystemExit`, so that `except Exception` does not swallow it and an uncaught one prints no traceback.
    """

    def __init__(self, why: str = "the test is over") -> None:
        super().__init__(0)
        self.why = why

    def __str__(self) -> str:
        return self.why


class ProtocolError(RuntimeError):
    """The harness refused a request: an event, signal or device that the scenario does not declare, or bad arguments."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message if not help else "%s (%s)" % (message, help))
        self.message = message
        self.help = help
        self.about: object = None  # what the request was about that had no reply of its own


class Deadlock(SystemExit):
    """All threads of the program wait for each other; what each of them waits for is on standard error.

    It is a `SystemExit`, so that `except Exception` does not swallow it.
    """

    def __init__(self) -> None:
        super().__init__(1)

    def __str__(self) -> str:
        return "all threads of the program wait for each other"


class Busy(SystemExit):
    """A loop that never waits keeps all other threads from running; its place is on standard error."""

    def __init__(self) -> None:
        super().__init__(1)

    def __str__(self) -> str:
        return "a loop that never waits keeps all other threads from running"


class ChildLives(SystemExit):
    """The program waits while a child process lives, for which it has not waited; its place is on standard error."""

    def __init__(self) -> None:
        super().__init__(1)

    def __str__(self) -> str:
        return "the program waits while a child process lives"


class Unsupported(RuntimeError):
    """What would run in real time beside the simulated one."""
