"""`Logger`: lines on standard error with a level, which the results count."""

from __future__ import annotations

import sys

from hrdsl import link as _links
from hrdsl import told

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

#: The levels by their names, with the numbers of `logging`.
_LEVELS = {"debug": 10, "info": 20, "warn": 30, "error": 40, "fatal": 50}


class Logger:
    """Writes `[WARN] [1.250] [robot]: text`, with the simulated seconds since the start of the test, and tells the harness."""

    def __init__(self, name: str, level: str = "info") -> None:
        """What is less severe than the level (`debug`, `info`, `warn`, `error`, `fatal`) is left out. Raises `ValueError` for
        another."""
        if level not in _LEVELS:
            raise ValueError("no level %r; there are %s" % (level, ", ".join(_LEVELS)))
        self.name = name
        self.level = level

    def log(self, level: str, text: str, *args: Any) -> None:
        """Logs a text of this level, into which the arguments are put as by `%`."""
        number = _LEVELS[level]
        if number < _LEVELS[self.level]:
            return
        text = text % args if args else text
        link = _links._link
        seconds = (link.time if link is not None else 0) / 1e9
        sys.stderr.write("[%s] [%.3f] [%s]: %s\n" % (level.upper(), seconds, self.name, text))
        told.log(number, self.name, text)

    def debug(self, text: str, *args: Any) -> None:
        """Logs it for those who look for a fault."""
        self.log("debug", text, *args)

    def info(self, text: str, *args: Any) -> None:
        """Logs what is as it should be."""
        self.log("info", text, *args)

    def warn(self, text: str, *args: Any) -> None:
        """Logs what may become a fault."""
        self.log("warn", text, *args)

    def error(self, text: str, *args: Any) -> None:
        """Logs what has gone wrong."""
        self.log("error", text, *args)

    def fatal(self, text: str, *args: Any) -> None:
        """Logs what the program cannot get over."""
        self.log("fatal", text, *args)
