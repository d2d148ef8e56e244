"""Child processes, which live in real time beside the simulated one.

A program may run a child to its end: nothing else happens meanwhile, and simulated time stands still. What would race with the real
clock is refused: a look whether a child still lives, a time-out, and any wait of the program while it does. So that the refusal is no race
itself, a child counts as alive from its start until somebody has waited for it, whether it still runs or not.
"""

from __future__ import annotations

import os

from hrdsl.errors import Unsupported
from hrdsl.replace import Builtin, partial, put
from hrdsl.schedule import real_monotonic, real_sleep

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

    from hrdsl.schedule import Scheduler

#: What to do instead.
INSTEAD = "run it to its end first (subprocess.run, communicate(), wait()), or make it a `program` of the system"

#: So much is told of a command.
_LONGEST = 60

_STARTS = (
    "fork", "forkpty", "posix_spawn", "posix_spawnp",
    "spawnl", "spawnle", "spawnlp", "spawnlpe", "spawnv", "spawnve", "spawnvp", "spawnvpe",
)  # fmt: skip


def install() -> None:
    """Refuses what makes processes that nobody waits for. `posix.fork` stays as it is: hrdsl itself forks programs by it."""
    for name in _STARTS:
        put(name, _refusal(name), os)
    if hasattr(os, "_wrap_close"):
        _pipes(os._wrap_close)


def _pipes(kind: Any) -> None:
    """What `os.popen` returns is often not kept: its child is waited for as soon as nobody has it any more."""

    def get(self: Any, name: str) -> Any:
        found = getattr(self._stream, name)
        return partial(_call, self, found) if callable(found) else found

    def lines(self: Any) -> Any:
        yield from self._stream

    kind.__getattr__, kind.__iter__, kind.__del__ = get, lines, kind.close


def _call(pipe: object, function: Callable[..., Any], *args: Any, **how: Any) -> Any:
    return function(*args, **how)  # the pipe lives as long as that lasts


def _refusal(name: str) -> Callable[..., NoReturn]:
    def refuse(*args: Any, **how: Any) -> NoReturn:
        raise unsupported("os.%s" % name)

    return refuse


def unsupported(what: str) -> Unsupported:
    """What is raised where a process is to be started that would not be waited for."""
    return Unsupported(
        "%s starts a process that runs in real time, beside the simulated one; run a command to its end with subprocess.run, use threads,"
        " or make it a `program` of the system" % what
    )


def told(args: Any) -> str:
    """The command of a child, in short."""
    words = args if isinstance(args, (list, tuple)) else [args]
    text = " ".join(os.fsdecode(word) if isinstance(word, (bytes, os.PathLike)) else str(word) for word in words)
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def patch_subprocess(module: Any, scheduler: Scheduler) -> None:
    """To be called when `subprocess` is imported, before which a program has no children."""
    import selectors
    from types import SimpleNamespace

    from hrdsl import waits

    # A real clock and real pauses, for what it does after an interrupt.
    module._time, module.time = real_monotonic, SimpleNamespace(sleep=real_sleep)
    module._USE_POSIX_SPAWN = False
    if "poll" in waits.as_they_were and hasattr(selectors, "PollSelector"):

        class Selector(selectors.PollSelector):
            _selector_cls = waits.as_they_were["poll"]

        module._PopenSelector = Selector
    _popen(module.Popen, scheduler.children)
    _waits(scheduler.children)


def _popen(kind: Any, children: dict[int, str]) -> None:
    real_init, real_wait, real_communicate = kind.__init__, kind.wait, kind.communicate
    real_waitpid = os.waitpid

    def __init__(self: Any, *args: Any, **how: Any) -> None:
        real_init(self, *args, **how)
        children[self.pid] = told(self.args)

    def poll(self: Any) -> Any:
        if self.returncode is None:
            raise Unsupported("poll() asks whether `%s` still lives, which real time decides: %s" % (told(self.args), INSTEAD))
        return self.returncode

    def check(self: Any, timeout: float | None) -> None:
        if timeout is not None and self.returncode is None:
            raise Unsupported(
                "the time-out of `%s` would be one of real time; leave it out: a child that does not end is ended with the test, by the"
                " limits of the program" % told(self.args)
            )

    def wait(self: Any, timeout: float | None = None) -> Any:
        check(self, timeout)
        code = real_wait(self, timeout)
        children.pop(self.pid, None)
        return code

    def communicate(self: Any, input: Any = None, timeout: float | None = None) -> Any:
        check(self, timeout)
        return real_communicate(self, input, timeout)

    def send_signal(self: Any, sig: int) -> None:
        if self.returncode is None:  # it is there until it is waited for
            os.kill(self.pid, sig)

    def _try_wait(self: Any, wait_flags: int) -> tuple[int, int]:
        try:
            return real_waitpid(self.pid, wait_flags)
        except ChildProcessError:
            return self.pid, 0

    functions: list[Any] = [__init__, poll, wait, communicate, send_signal, _try_wait]
    for function in functions:
        real = getattr(kind, function.__name__)
        function.__qualname__, function.__doc__ = real.__qualname__, real.__doc__
        function.__wrapped__ = real  # whose arguments are shown
        setattr(kind, function.__name__, function)


def _waits(children: dict[int, str]) -> None:
    """The waits of `os` for a child: whom they have waited for lives no more."""

    def waiting(name: str, place: int, pid_of: Callable[[Any], int]) -> None:
        real: Any = getattr(os, name, None)

        def wait(*args: Any, **how: Any) -> Any:
            options = args[place] if len(args) > place else how.get("options", 0)
            if children and options & os.WNOHANG:
                asked = next(iter(children.values()))
                raise Unsupported("os.%s asks whether `%s` still lives, which real time decides: %s" % (name, asked, INSTEAD))
            found = real(*args, **how)
            if found is not None and not options & getattr(os, "WNOWAIT", 0):
                children.pop(pid_of(found), None)
            return found

        if real is not None:
            setattr(os, name, Builtin(wait, real, "os"))

    for name, place in (("wait", 9), ("waitpid", 1), ("wait3", 0), ("wait4", 1)):
        waiting(name, place, lambda found: int(found[0]))
    waiting("waitid", 2, lambda found: int(found.si_pid))
