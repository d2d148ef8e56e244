"""The node's log: `[INFO] [1735689600.000000]: text`, below warnings on standard output, else on standard error.

Programs that use `logging` find rospy's logger `rosout` there, with its handler. Others do without that module.
"""

from __future__ import annotations

import os
import sys
import time

from hrdsl import told

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

#: By their names in `logging`: their number there, and their name here.
_LEVELS = {
    "debug": (10, "DEBUG"), "info": (20, "INFO"), "warning": (30, "WARN"), "warn": (30, "WARN"), "error": (40, "ERROR"),
    "critical": (50, "FATAL"),
}  # fmt: skip

_threshold = 20
_is_configured = False
_last_times: dict[Any, int] = {}
_last_texts: dict[Any, str] = {}
_once: set[Any] = set()


def set_level(level: int) -> None:
    """What is below this level of `logging` is left out."""
    global _threshold
    _threshold = level
    if _is_configured:
        import logging

        logging.getLogger("rosout").setLevel(level)


def configure() -> None:
    """Lets `logging` have what rospy puts there, as soon as the program uses it."""
    from hrdsl.replace import when_imported

    when_imported("logging", _configure)


def _configure(logging: Any) -> None:
    global _is_configured
    if _is_configured:
        return
    _is_configured = True

    class RosStreamHandler(logging.Handler):  # type: ignore[misc, name-defined]
        def emit(self, record: Any) -> None:
            name = _LEVELS.get(record.levelname.lower(), (0, record.levelname))[1]
            text = logging.Formatter().format(record)
            _write(record.levelno, name, text, record)

    rosout = logging.getLogger("rosout")
    rosout.setLevel(_threshold)
    rosout.addHandler(RosStreamHandler())
    # rospy's own configuration sends all else to a file.
    logging.getLogger().setLevel(logging.INFO)
    logging.getLogger().addHandler(logging.NullHandler())
    logging.getLogger("rospy").addHandler(logging.NullHandler())


def _write(level: int, name: str, text: str, record: Any = None) -> None:
    form = os.environ.get("ROSCONSOLE_FORMAT")
    if form is None:
        line = "[%s] [%f]: %s\n" % (name, time.time(), text)
    else:
        line = _formatted(form, name, text, record)
    (sys.stdout if level < 30 else sys.stderr).write(line)
    from rospy.names import get_name

    told.log(level, get_name(), text)


def _formatted(form: str, name: str, text: str, record: Any) -> str:
    from rospy.names import get_name

    values = {"severity": name, "message": text, "walltime": "%f" % time.time(), "time": "%f" % time.time(), "node": get_name()}
    for tag, attribute in (("thread", "thread"), ("logger", "name"), ("file", "pathname"), ("line", "lineno"), ("function", "funcName")):
        values[tag] = str(getattr(record, attribute, "rosout" if tag == "logger" else ""))
    for tag, value in values.items():
        form = form.replace("${%s}" % tag, value)
    for tag in ("walltime", "time"):
        while "${%s:" % tag in form:
            start = form.index("${%s:" % tag)
            end = form.index("}", start)
            form = form[:start] + time.strftime(form[start + len(tag) + 3 : end]) + form[end + 1 :]
    return form + "\n"


def _log(level: str, msg: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
    number, name = _LEVELS[level]
    if not kwargs and not (_is_configured or "logging" in sys.modules) and "ROSCONSOLE_FORMAT" not in os.environ:
        if number < (_threshold if _in_use else 30):
            return
        if len(args) == 1 and isinstance(args[0], dict) and args[0]:
            args = args[0]  # type: ignore[assignment]  # as `logging` takes it
        text = str(msg) % args if args else str(msg)
        if _in_use:
            _write(number, name, text)
        else:  # as `logging` does without a handler
            sys.stderr.write(text + "\n")
        return
    import logging

    if _in_use:
        _configure(logging)
    logger = logging.getLogger("rosout")
    child = kwargs.pop("logger_name", None)
    if child:
        logger = logger.getChild(child)
    logger.log(number, msg, *args, stacklevel=3, **kwargs)


#: Whether there is a node; before, `logging` decides what becomes of what is logged.
_in_use = False


def begin(level: int | None) -> None:
    """There is a node."""
    global _in_use
    _in_use = True
    if level is not None:
        set_level({1: 10, 2: 20, 4: 30, 8: 40, 16: 50}[level])
    configure()


def _caller() -> Any:
    frame = sys._getframe(2)
    return frame.f_code.co_filename, frame.f_lineno, frame.f_lasti


def _is_due(place: Any, period: float) -> bool:
    from rospy.rostime import nanoseconds

    now = nanoseconds()
    last = _last_times.get(place)
    if last is not None and now - last <= round(period * 1e9):
        return False
    _last_times[place] = now
    return True


def _functions(level: str, shown: str) -> tuple[Callable[..., None], ...]:
    def log(msg: Any, *args: Any, **kwargs: Any) -> None:
        _log(level, msg, args, kwargs)

    def throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
        if not period or _is_due(_caller(), period):
            _log(level, msg, args, kwargs)

    def throttle_identical(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
        place = _caller()
        is_due = period is not None and _is_due(place, period)
        is_new = _last_texts.get(place) != msg
        _last_texts[place] = msg
        if is_new or is_due:
            _log(level, msg, args, kwargs)

    def once(msg: Any, *args: Any, **kwargs: Any) -> None:
        place = _caller()
        if place not in _once:
            _once.add(place)
            _log(level, msg, args, kwargs)

    made = (log, throttle, throttle_identical, once)
    for function, end in zip(made, ("", "_throttle", "_throttle_identical", "_once")):
        function.__name__ = function.__qualname__ = "log%s%s" % (shown, end)
        function.__doc__ = "Logs a text" + {"": ".", "_throttle": ", at most once in a period (seconds).", "_once": ", the first time only."}.get(
            end, ", if it is another than the last, or a period (seconds) has passed."
        )
    return made


logdebug, logdebug_throttle, logdebug_throttle_identical, logdebug_once = _functions("debug", "debug")
loginfo, loginfo_throttle, loginfo_throttle_identical, loginfo_once = _functions("info", "info")
logwarn, logwarn_throttle, logwarn_throttle_identical, logwarn_once = _functions("warning", "warn")
logerr, logerr_throttle, logerr_throttle_identical, logerr_once = _functions("error", "err")
logfatal, logfatal_throttle, logfatal_throttle_identical, logfatal_once = _functions("critical", "fatal")
logout, logerror = loginfo, logerr


def _internal(level: str) -> Callable[..., None]:
    def log(msg: Any, *args: Any, **kwargs: Any) -> None:
        """What rospy logs of itself, which goes to a file; and so nowhere here."""

    log.__name__ = "rospy" + level
    return log


rospydebug, rospyinfo, rospywarn, rospyerr = (_internal(level) for level in ("debug", "info", "warn", "err"))
