"""Loggers by name."""

from __future__ import annotations

from rclpy.impl import rcutils_logger
from rclpy.impl.logging_severity import LoggingSeverity as LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from pathlib import Path

_root_logger = RcutilsLogger()


def get_logger(name: str) -> RcutilsLogger:
    """A logger of this name."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def initialize() -> None:
    """There is nothing to do."""


def shutdown() -> None:
    """Forgets all levels."""
    rcutils_logger.levels.clear()
    rcutils_logger.levels[""] = LoggingSeverity.INFO


def clear_config() -> None:
    """Forgets all levels."""
    shutdown()


def set_logger_level(name: str, level: int) -> None:
    """Sets the level of a logger."""
    rcutils_logger.set_level(name, LoggingSeverity(level))


def get_logger_level(name: str) -> LoggingSeverity:
    """The level that was set for a logger, if one was."""
    return LoggingSeverity(rcutils_logger.levels.get(name, LoggingSeverity.UNSET))


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """The level of a logger, its own or inherited."""
    return LoggingSeverity(rcutils_logger.effective_level(name))


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """The level of this name."""
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError("Failed to get log severity from name") from None


def get_logging_directory() -> Path:
    """The folder that ROS would write files of its log to."""
    import os
    from pathlib import Path

    folder = os.environ.get("ROS_LOG_DIR")
    return Path(folder) if folder else Path(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros"))) / "log"
