"""Finds the modules that a fork server can import before it knows of any test, so that no test can tell.

They are those that the program's files import at their outermost level, whatever happens, as far as they are none of the
project's own. Each is tried in a process of its own: one whose import leaves more behind than modules is left to the tests.
"""

from __future__ import annotations

import builtins
import os
import posix
import sys

import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`

from hrdsl.alarms import real_alarm

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any, Iterable

    from hrdsl.runner import PreparedRun

#: Seconds of wall time for an import.
_PATIENCE = 30

#: What is not the project's own even if it lies in its folder.
_FOREIGN = ("site-packages", "dist-packages")

#: Folders that a project's modules are not imported from.
_SKIPPED = ("__pycache__", "node_modules", "hrdsl-out")

#: What the interpreter tells of (`sys.addaudithook`) that an import is not to do.
_EVENTS = {
    "os.chdir", "os.chmod", "os.chown", "os.exec", "os.fork", "os.forkpty", "os.kill", "os.killpg", "os.link", "os.mkdir",
    "os.posix_spawn", "os.remove", "os.rename", "os.rmdir", "os.spawn", "os.symlink", "os.system", "os.truncate", "os.utime",
    "shutil.copyfile", "signal.pthread_kill", "socket.__new__", "socket.getaddrinfo", "sqlite3.connect", "subprocess.Popen",
    "_thread.start_new_thread", "_thread.start_joinable_thread",
}  # fmt: skip

#: Modules that draw chance at their import, and are given the test's when it begins (`hrdsl.chance`).
_RESEEDED = ("random", "numpy.random")


def find(run: PreparedRun, own: list[str]) -> list[str]:
    """The modules, in the order in which the program's files import them; `own` are the project's folders, absolute.
    Imports them."""
    files = [os.path.abspath(name) for name in [*([] if run.option else run.words[:1]), *run.files]]
    project = _Project(own, {os.getcwd(), *map(os.path.dirname, files[:1])})
    taken = {name.partition(".")[0] for name in sys.modules} & project.names
    found: list[str] = []
    if taken - {"hrdsl"}:  # which would never be found, as these are there already
        raise SystemExit("the project has a module `%s`, which a fork server needs itself" % min(taken))
    for name in _in_fork(lambda: "\n".join(_imports(files))).split():
        if name not in sys.modules and _in_fork(lambda: _try(name, run, project)) == "clean":
            __import__(name)
            found.append(name)
    return found


class _Project:
    """The modules of the project itself."""

    def __init__(self, folders: list[str], scripts: set[str]) -> None:
        """`scripts` are folders in which modules are searched for even if they are packages."""
        self._folders = [os.path.realpath(folder) for folder in folders]
        self.names: set[str] = set()
        for folder in self._folders:
            for place, folders_in, files in os.walk(folder):
                folders_in[:] = [name for name in folders_in if self._is_searched(os.path.join(place, name))]
                names = {name.partition(".")[0] for name in files if name.endswith((".py", ".so", ".pyc"))}
                if "__init__" not in names or place in scripts:  # what is in a package is found by the name of that
                    self.names |= names
                if names and place != folder:
                    self.names.add(os.path.basename(place))

    def _is_searched(self, folder: str) -> bool:
        name = os.path.basename(folder)
        return not (name.startswith(".") or name in _SKIPPED + _FOREIGN or os.path.exists(os.path.join(folder, "pyvenv.cfg")))

    def has(self, module: Any) -> bool:
        """Whether it is the project's, or one of the project's has its name."""
        if getattr(module, "__name__", "").partition(".")[0] in self.names:
            return True
        place = os.path.realpath(getattr(module, "__file__", None) or "/")
        is_foreign = any(part in _FOREIGN for part in place.split(os.sep))
        return not is_foreign and any(place.startswith(folder + os.sep) for folder in self._folders)


def _in_fork(call: Any) -> str:
    """What a call returns in a process of its own, as UTF-8; nothing if it does not return."""
    reading, writing = os.pipe()
    if not posix.fork():
        try:
            os.write(writing, call().encode())
        finally:
            os._exit(0)
    os.close(writing)
    with open(reading, "rb") as answer:
        text = answer.read()
    os.waitpid(-1, 0)
    return text.decode()


def _imports(files: Iterable[str]) -> list[str]:
    """What the files import at their outermost level, each once."""
    import ast

    names: dict[str, None] = {}
    for path in files:
        try:
            with open(path, "rb") as file:
                body = ast.parse(file.read()).body
        except (OSError, SyntaxError, ValueError):
            continue  # which is told when the file runs
        for statement in body:
            if isinstance(statement, ast.Import):
                names.update((alias.name, None) for alias in statement.names)
            elif isinstance(statement, ast.ImportFrom) and statement.module and not statement.level:
                names[statement.module] = None
    return list(names)


def _try(name: str, run: PreparedRun, project: _Project) -> str:
    """Imports a module: `clean` if nothing but modules comes of it."""
    before = _State(run)
    faults: list[str] = []
    streams = os.memfd_create("output", 0)
    os.dup2(streams, 1)
    os.dup2(streams, 2)
    known, descriptors = set(sys.modules), _descriptors()
    sys.dont_write_bytecode = True
    _signal.signal(_signal.SIGALRM, _signal.SIG_DFL)
    real_alarm(_PATIENCE)
    run.simulation.chance.on_draw = lambda: None if _is_reseeded(sys._getframe(1)) else faults.append("chance")

    def listen(event: str, args: Any) -> None:
        if _is_fault(event, args):
            faults.append(event)
            raise PermissionError(1, "not while a fork server imports: %s" % event)

    sys.addaudithook(listen)
    __import__(name)
    sys.stdout.flush()
    sys.stderr.flush()
    if faults or _descriptors() != descriptors or os.fstat(streams).st_size or before.differs(_State(run)):
        return "not clean"
    imported = [module for added, module in list(sys.modules.items()) if added not in known]
    return "not clean" if any(project.has(module) for module in imported) else "clean"


def _is_reseeded(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("__name__") in _RESEEDED and frame.f_code.co_name == "<module>":
            return True
        frame = frame.f_back
    return False


def _is_fault(event: str, args: Any) -> bool:
    if event == "open":
        mode, flags = args[1], args[2]
        return bool(mode and set(mode) & set("wax+")) or bool((flags or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
    return event in _EVENTS


def _descriptors() -> list[str]:
    return sorted(os.listdir("/proc/self/fd"))


class _State:
    """What an import can change besides modules."""

    def __init__(self, run: PreparedRun) -> None:
        signals = [_signal.getsignal(number) for number in range(1, _signal.NSIG)]
        hooks = [sys.stdin, sys.stdout, sys.stderr, sys.excepthook, sys.displayhook, sys.gettrace(), sys.getprofile()]
        self._same: list[Any] = [*hooks, *signals, *vars(builtins).values()]
        self._equal: list[Any] = [os.getcwd(), dict(os.environ), list(sys.path), list(sys.argv), sorted(vars(builtins))]
        self._equal += [_threads(), len(run.simulation.scheduler.tasks), sys.getrecursionlimit()]

    def differs(self, other: _State) -> bool:
        """Whether anything is not as it was."""
        if self._equal != other._equal or len(self._same) != len(other._same):
            return True
        return any(one is not another for one, another in zip(self._same, other._same))


def _threads() -> list[str]:
    return sorted(os.listdir("/proc/self/task"))
