"""Loggers, which write to standard error as ROS 2's console does: `[INFO] [1735689600.000000000] [name]: text`."""

from __future__ import annotations

import os
import sys

from hrdsl import told
from rclpy import _world
from rclpy.impl.logging_severity import LoggingSeverity

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any

#: The levels that were set, by the loggers' names; that of all others is the one of "".
levels: dict[str, int] = {"": LoggingSeverity.INFO}

_NAMES = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
_COLOURS = {10: "\033[32m", 20: "\033[0m", 30: "\033[33m", 40: "\033[31m", 50: "\033[31m"}
_OPTIONS = ("throttle_duration_sec", "throttle_time_source_type", "skip_first", "once")


class _Console:
    """How lines are written; what the environment says of it is read once."""

    def __init__(self) -> None:
        environment = os.environ.get
        self.form = environment("RCUTILS_CONSOLE_OUTPUT_FORMAT", "[{severity}] [{time}] [{name}]: {message}")
        self.is_plain = self.form == "[{severity}] [{time}] [{name}]: {message}"
        self.is_coloured = environment("RCUTILS_COLORIZED_OUTPUT") == "1"
        self.to_stdout = environment("RCUTILS_LOGGING_USE_STDOUT") == "1"

    def write(self, severity: int, name: str, message: str, frame: FrameType) -> None:
        nanos = _world.EPOCH + _world.now()
        seconds = "%d.%09d" % divmod(nanos, 10**9)
        if self.is_plain:
            line = "[%s] [%s] [%s]: %s" % (_NAMES[severity], seconds, name, message)
        else:
            values = {
                "severity": _NAMES[severity],
                "name": name,
                "message": message,
                "time": seconds,
                "time_as_nanoseconds": "%d" % nanos,
                "function_name": frame.f_code.co_name,
                "file_name": os.path.abspath(frame.f_code.co_filename),
                "line_number": "%d" % frame.f_lineno,
            }
            line = _formatted(self.form, values)
        if self.is_coloured:
            line = "%s%s\033[0m" % (_COLOURS[severity], line)
        stream = sys.stdout if self.to_stdout else sys.stderr
        stream.write(line + "\n")
        stream.flush()


def _formatted(form: str, values: dict[str, str]) -> str:
    """Puts the values in; braces around anything else stay as they are."""
    parts = form.replace("\\n", "\n").replace("\\t", "\t").split("{")
    text = parts[0]
    for part in parts[1:]:
        name, brace, rest = part.partition("}")
        text += values[name] + rest if brace and name in values else "{" + part
    return text


_console: _Console | None = None
_is_silent = False


def _the_console() -> _Console:
    global _console
    if _console is None:
        _console = _Console()
    return _console


def silence(is_silent: bool) -> None:
    """Whether lines are not written to the console."""
    global _is_silent
    _is_silent = is_silent


def effective_level(name: str) -> int:
    """The level of a logger: its own, or that of the nearest one above that has one."""
    while name:
        level = levels.get(name, 0)
        if level:
            return level
        name = name.rpartition(".")[0]
    return levels[""] or LoggingSeverity.INFO


def set_level(name: str, level: int) -> None:
    """Sets a logger's own level; that of "" is for all that have none."""
    levels[name] = level


class RcutilsLogger:
    """A logger."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.contexts: dict[tuple[Any, int], dict[str, Any]] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """The logger of this name below this one."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(self.name + "." + name if self.name else name)

    def set_level(self, level: int) -> None:
        """What is less severe is not written any more."""
        set_level(self.name, LoggingSeverity(level))

    def get_effective_level(self) -> LoggingSeverity:
        """What is less severe is not written."""
        return LoggingSeverity(effective_level(self.name))

    def is_enabled_for(self, severity: int) -> bool:
        """Whether such lines are written."""
        return LoggingSeverity(severity) >= effective_level(self.name)

    def log(self, message: str, severity: int, **kwargs: Any) -> bool:
        """Writes a line, unless the level or an option says otherwise: whether it did."""
        return self._log(message, severity, kwargs, sys._getframe(1))

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 10, kwargs, sys._getframe(1))

    def info(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 20, kwargs, sys._getframe(1))

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 30, kwargs, sys._getframe(1))

    def warn(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 30, kwargs, sys._getframe(1))

    def error(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 40, kwargs, sys._getframe(1))

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Writes a line of that severity."""
        return self._log(message, 50, kwargs, sys._getframe(1))

    def _log(self, message: str, severity: int, options: dict[str, Any], frame: FrameType) -> bool:
        if severity < effective_level(self.name):
            return False
        name = options.pop("name", self.name) if options else self.name
        if not self._wanted(frame, LoggingSeverity(severity), name, options):
            return False
        if not isinstance(message, str):
            raise TypeError(
                "rclpy_logging_rcutils_log(): incompatible function arguments: the message must be a str, not %r"
                % type(message).__name__
            )
        if not _is_silent:
            _the_console().write(severity, name, message, frame)
        told.log(severity, name, message)
        return True

    def _wanted(self, frame: FrameType, severity: int, name: str, options: dict[str, Any]) -> bool:
        """Whether the options let it be written. What they remember is of the place that logs."""
        filters = _filters(options)
        place = (frame.f_code, frame.f_lasti)
        context = self.contexts.get(place)
        if context is None:
            context = self.contexts[place] = {"name": name, "severity": severity, "filters": filters}
            context.update(last=0, first=True, once=True, **{"of_" + key: value for key, value in options.items()})
        else:
            _check_same(context, severity, name, filters, options)
        for each in filters:
            if not _passes(each, context, options):
                return False
        return True


def _filters(options: dict[str, Any]) -> list[str]:
    for key in options:
        if key not in _OPTIONS:
            raise TypeError('parameter "%s" is not one of the recognized logging options "%s"' % (key, list(_OPTIONS)))
    found = []
    if options.get("throttle_duration_sec") or options.get("throttle_time_source_type"):
        if not options.get("throttle_duration_sec"):
            raise TypeError(
                'required parameter "throttle_duration_sec" not specified '
                'but is required for the the logging filter "throttle"'
            )
        found.append("throttle")
    found.extend(each for each in ("skip_first", "once") if options.get(each))
    return found


def _check_same(context: dict[str, Any], severity: int, name: str, filters: list[str], options: dict[str, Any]) -> None:
    if severity != context["severity"]:
        raise ValueError("Logger severity cannot be changed between calls.")
    if name != context["name"]:
        raise ValueError("Logger name cannot be changed between calls.")
    if filters != context["filters"]:
        raise ValueError("Requested logging filters cannot be changed between calls.")
    if filters and any(context.get("of_" + key) != value for key, value in options.items()):
        raise ValueError("Logging filter parameters cannot be changed between calls.")


def _passes(which: str, context: dict[str, Any], options: dict[str, Any]) -> bool:
    if which == "throttle":
        from rclpy.clock import Clock

        clock = options.get("throttle_time_source_type")
        if clock is None:
            now = _world.EPOCH + _world.now()
        elif isinstance(clock, Clock):
            now = clock.now().nanoseconds
        else:
            raise ValueError('Received throttle_time_source_type of "%s" is not a clock instance' % (clock,))
        if now < context["last"] + options["throttle_duration_sec"] * 1e9:
            return False
        context["last"] = now
        return True
    key = "first" if which == "skip_first" else "once"
    passes, context[key] = bool(context[key]), False
    return passes != (which == "skip_first")
