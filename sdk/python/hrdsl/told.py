"""What a program tells the harness of itself, beside what it writes: its log, and that something in it has failed.

Nothing of it is told when the test is over already, nor by a process that the program has forked: both may go on to log."""

from __future__ import annotations

import _thread
import json
import sys

from hrdsl import link as _links

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

    from hrdsl.schedule import Scheduler

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


#: Exceptions of callbacks that a client library has passed on to the program, with the threads in which it did.
_left: list[tuple[BaseException, int]] = []


def left(error: BaseException, scheduler: Scheduler) -> None:
    """An exception whose place is kept leaves the library. If it ends the program or its thread, that is told; if the program
    catches it, the harness is told as soon as the program waits again, or ends."""
    if place_of(error) is not None:
        _left.append((error, _thread.get_ident()))
        scheduler.before_wait = lambda: _settle(scheduler)


def _settle(scheduler: Scheduler) -> None:
    """Tells of what this thread has caught: it is not on its way any more, nor what was raised in its place."""
    me, on_the_way = _thread.get_ident(), _chain(sys.exc_info()[1])
    for error, thread in _left[:]:
        if thread == me and id(error) not in on_the_way:
            _caught(error, thread)
    if not _left:
        scheduler.before_wait = None


def caught_all() -> None:
    """The program has come to its end by itself, and so has caught what it was passed."""
    for error, thread in _left[:]:
        _caught(error, thread)


def _caught(error: BaseException, thread: int) -> None:
    _left.remove((error, thread))
    place = place_of(error)
    if place is not None:
        failed(*place, error)


def ended_by(error: BaseException | None) -> None:
    """The exception has ended the program or a thread, where others tell of it."""
    chain = _chain(error)
    _left[:] = [entry for entry in _left if id(entry[0]) not in chain]


def _chain(error: BaseException | None) -> set[int]:
    """The exception, and those in whose place it was raised."""
    found: set[int] = set()
    rest = [error]
    while rest:
        each = rest.pop()
        if each is not None and id(each) not in found:
            found.add(id(each))
            rest += [each.__context__, each.__cause__]
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
