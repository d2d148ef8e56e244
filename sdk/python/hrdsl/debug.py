"""`breakpoint()` and the debugger pdb in a program under test: on the terminal, or refused."""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`
import os
import sys

from hrdsl.replace import when_imported

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

_STREAMS = (0, 1, 2)


def is_wanted() -> bool:
    """Whether somebody is at a terminal, to debug this program."""
    return os.environ.get("HRDSL_DEBUG") == "1"


def install() -> None:
    """The program's standard input is empty and its output captured, so pdb gets the terminal while it asks. Simulated
    time stands still meanwhile, as it does whenever the program makes no request."""
    if not is_wanted() and not os.environ.get("PYTHONBREAKPOINT"):
        sys.breakpointhook = _refuse
    when_imported("pdb", _replace)


def has_left(error: BaseException) -> bool:
    """Whether it ends the program because somebody has left the debugger."""
    bdb = sys.modules.get("bdb")
    return bdb is not None and isinstance(error, bdb.BdbQuit)


def _refuse(*args: object, **kwargs: object) -> NoReturn:
    raise RuntimeError("nobody can debug a program in a test; for breakpoint() run `hrdsl sim --test NAME --debug`")


def _replace(module: Any) -> None:
    real = module.Pdb

    class Pdb(real):  # type: ignore[misc, valid-type]
        def interaction(self, *args: Any, **kwargs: Any) -> None:
            leave = _take_terminal() if is_wanted() else _refuse()
            try:
                super().interaction(*args, **kwargs)
            finally:
                leave()

    Pdb.__module__, Pdb.__qualname__, Pdb.__doc__ = "pdb", "Pdb", real.__doc__
    module.Pdb = Pdb


def _take_terminal() -> Callable[[], None]:
    """Makes the terminal the standard input, output and error, as descriptors, so that lines can be edited; what it
    returns gives it back."""
    try:
        terminal = os.open("/dev/tty", os.O_RDWR)
    except OSError as error:
        raise RuntimeError("there is no terminal to debug the program on: /dev/tty: %s" % error.strerror) from None
    kept = [os.dup(stream) for stream in _STREAMS]
    group, own = os.tcgetpgrp(terminal), os.getpgrp()
    # A process group that may not read from the terminal in the background. 0 is the harness's own, seen from a namespace
    # of processes that it is not in: it has the terminal.
    in_background = own not in (0, group)

    def leave() -> None:
        _flush()
        if in_background:
            _to_foreground(terminal, group)
        for stream, before in zip(_STREAMS, kept):
            os.dup2(before, stream)
            os.close(before)
        os.close(terminal)

    _flush()
    if in_background:
        _to_foreground(terminal, own)
    for stream in _STREAMS:
        os.dup2(terminal, stream)
    return leave


def _to_foreground(terminal: int, group: int) -> None:
    blocked = _signal.pthread_sigmask(_signal.SIG_BLOCK, [_signal.SIGTTOU])
    try:
        os.tcsetpgrp(terminal, group)
    finally:
        _signal.pthread_sigmask(_signal.SIG_SETMASK, blocked)


def _flush() -> None:
    sys.stdout.flush()
    sys.stderr.flush()
