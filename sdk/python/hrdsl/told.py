"""What a program tells the harness of itself, beside what it writes: its log, and that something in it has failed.

Nothing of it is told when the test is over already, nor by a process that the program has forked: both may go on to log."""

from __future__ import annotations

import json

from hrdsl import link as _links

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

#: So many characters of a text are sent at most.
LONGEST = 2000

_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode


def failed(node: str, where: str, error: BaseException) -> None:
    """Tells that an exception was raised where nobody of the program hears of it, such as in a callback: the test ends, and is
    an error. The program goes on until then."""
    text = "%s raised %s" % (where, _in_words(error))
    if isinstance(error, ImportError):
        from hrdsl import advice

        told = advice.about(error)
        text += "; %s" % told if told else ""
    _tell({"request": "failed", "node": node, "text": text[:LONGEST]})


def log(level: int, node: str, text: str) -> None:
    """Tells what the program has logged; the level is a number of `logging`."""
    name = "debug" if level < 20 else "info" if level < 30 else "warn" if level < 40 else "error" if level < 50 else "fatal"
    _tell({"request": "log", "level": name, "node": node, "text": text[:LONGEST]})


def place(error: BaseException, node: str, where: str) -> None:
    """Keeps with an exception in which callback of which node it was raised, for those who report it."""
    if not hasattr(error, "_hrdsl_place"):
        try:
            error._hrdsl_place = node, where  # type: ignore[attr-defined]
        except AttributeError:  # it has no room for that
            pass


def place_of(error: BaseException | None) -> tuple[str, str] | None:
    """The node and the callback in which it was raised, if that is known."""
    found: tuple[str, str] | None = getattr(error, "_hrdsl_place", None)
    return found


def name_of(callback: Any) -> str:
    """What a callback is called in the program's text."""
    while hasattr(callback, "func"):  # `functools.partial`
        callback = callback.func
    return str(getattr(callback, "__qualname__", type(callback).__qualname__))


def _in_words(error: BaseException) -> str:
    try:
        text = str(error)
    except Exception:
        text = "<its text cannot be made>"
    kind = type(error).__name__
    return "%s: %s" % (kind, text) if text else kind


def _tell(message: dict[str, str]) -> None:
    link = _links._link
    if link is not None and link.greeted and not link.stopped and link.is_ours():
        # Halves of characters, as names of files can have them, are no UTF-8.
        whole = {key: text.encode("utf-8", "replace").decode() for key, text in message.items()}
        link.tell(_encode(whole).encode("ascii") + b"\n", message["request"])
