"""Runs a script as `__main__` with simulated time, seeded chance and, if asked, coverage.

    python -m hrdsl.run [--coverage FILE]... (script.py | -m module | -c code) args...

The environment has HRDSL_SEED, the two descriptors of the protocol, and optionally HRDSL_SYS_PATH (folders to search
for modules), HRDSL_MIDDLEWARE (`ros1` or `ros2`), HRDSL_BINDING (see `hrdsl.binding`), HRDSL_COVERAGE_FD (the descriptor
that coverage is written to), HRDSL_COVERAGE_PACKAGE (the folder that has coverage.py), HRDSL_COVERAGE_CACHE and HRDSL_LINES (1: which
lines ran when is written beside the coverage, see `hrdsl.lines`). With
HRDSL_DEBUG=1 the debugger gets the terminal, and there is no coverage. With HRDSL_FORK_SERVER it is not a run, but a server that
forks runs (see `hrdsl.forkserver`).
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # without the enumerations of `signal`
import builtins
import os
import sys

from hrdsl import link as _links
from hrdsl import debug, told, virtual
from hrdsl.errors import ProtocolError, Stopped

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

    from hrdsl.cover import Recorder
    from hrdsl.lines import LineRecorder
    from hrdsl.link import Link
    from hrdsl.mutated import Switch

USAGE = "usage: python -m hrdsl.run [--coverage FILE]... (script.py | -m module | -c code) args...\n"


def main(argv: list[str]) -> NoReturn:
    """Never returns: exits with 0 at a normal end or a stop, with 1 after an uncaught exception."""
    words = _arguments(argv)
    if "HRDSL_FORK_SERVER" in os.environ:
        from hrdsl import forkserver

        run = PreparedRun(words, _links.unconnected())
        out, seed = forkserver.serve(run)
        run.simulation.begin(seed)
    else:
        out = _coverage_descriptor()
        try:
            link = _links.the_link()
        except ProtocolError as error:
            sys.exit("hrdsl: %s" % error)
        run = PreparedRun(words, link, out is not None)
    run.run(out)


class PreparedRun:
    """A run of the program, made ready as far as that is possible before anything is known of the test."""

    def __init__(self, arguments: tuple[list[str], str, list[str]], link: Link, measures: bool = True) -> None:
        """Replaces what the program sees of time, chance and the machine. `arguments` are the files whose coverage is measured,
        `-m` or `-c` if the program is a module or code, and its words."""
        self.files, self.option, self.words = arguments
        self.link = link
        _search_path()
        for name in ("stdout", "stderr"):
            stream = getattr(sys, name)
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(line_buffering=True)
        self.recorder: Recorder | None = None
        if self.files and measures and not debug.is_wanted():  # the debugger traces, too
            from hrdsl.cover import Recorder

            environment = os.environ.get
            self.recorder = Recorder(self.files, environment("HRDSL_COVERAGE_PACKAGE"), environment("HRDSL_COVERAGE_CACHE"))
        self.simulation = virtual.Simulation(link, int(os.environ.get("HRDSL_SEED", "0")))
        self.lines: LineRecorder | None = None
        if os.environ.pop("HRDSL_LINES", "") == "1" and self.recorder is not None:
            from hrdsl.lines import LineRecorder

            self.lines = LineRecorder(self.files, link, self.simulation.scheduler)
        debug.install()
        self.compiled: Any = None  # the program's file, if it was compiled beforehand
        sys.argv = list(self.words)
        if self.option == "-c":
            sys.argv[0] = self.option
        _middleware()

    def compile(self) -> None:
        """Compiles the program's file beforehand; not if that says anything (a warning, an error), which each run is to say."""
        if self.option:
            return
        said, stderr = os.memfd_create("said", os.MFD_CLOEXEC), os.dup(2)
        os.dup2(said, 2)
        try:
            compiled = _compiled(os.path.abspath(self.words[0]))
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            compiled = None
        sys.stderr.flush()
        os.dup2(stderr, 2)
        if not os.fstat(said).st_size:
            self.compiled = compiled
        for descriptor in (said, stderr):
            os.close(descriptor)

    def run(self, out: int | None) -> NoReturn:
        """Runs the program in this process, and ends it; coverage goes to the descriptor `out`."""
        # Whoever started the harness may ignore some, as `nohup` does; the program is not to depend on it.
        _signal.signal(_signal.SIGINT, _signal.default_int_handler)
        _signal.signal(_signal.SIGHUP, _signal.SIG_DFL)
        _signal.signal(_signal.SIGTERM, _terminated)
        link, scheduler = self.link, self.simulation.scheduler
        self.simulation.watch()
        switch = _switch()
        if self.lines is not None and out is not None:
            self.lines.start()
        status = 1
        try:
            status, is_stopped = _status(lambda: _run(self, switch))
            if status == 0 and not link.greeted and link.is_ours() and not is_stopped:
                status = _status(lambda: _check_use(self.words, self.option))[0]
            if not is_stopped and link.is_ours():
                status = _status(_join_threads)[0] or status
            if link.is_ours():
                for call in link.on_end:
                    status = _status(call)[0] or status
            if scheduler.failed:
                status = status or 1
            if status == 0 and link.is_ours() and not link.stopped:
                told.caught_all()
                link.done()
        finally:
            scheduler.close()
            if link.is_ours():  # not in a process that the program has forked
                _signal.signal(_signal.SIGTERM, _signal.SIG_IGN)
                if self.recorder is not None and out is not None:
                    _save(self.recorder, out, self.lines)
        if switch is not None and link.is_ours():
            _leave(status)
        sys.exit(status)


def _leave(status: int) -> NoReturn:
    """Ends the process without taking apart what is in it, which costs as much as all else of a short run. Only for mutants, of which no file is
    kept: a buffer that nobody has flushed is lost."""
    import atexit

    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, AttributeError):
            pass  # the program has closed it, or put something else in its place
    os._exit(status)


def _save(recorder: Recorder, out: int, lines: LineRecorder | None) -> None:
    try:
        recorder.stop()
        recorder.write(out, lines and lines.told())
    except Exception as error:  # no coverage is no reason to call the program's run a failure
        sys.stderr.write("hrdsl: coverage was not written: %r\n" % error)


def _arguments(argv: list[str]) -> tuple[list[str], str, list[str]]:
    """The files for coverage, `-m` or `-c` if it is one of them, and the rest."""
    files: list[str] = []
    kind, rest = "", list(argv)
    while rest and rest[0].startswith("-"):
        option = rest.pop(0)
        if option in ("-m", "-c"):
            kind = option
            break
        if option != "--coverage" or not rest:
            _refuse()
        files.append(rest.pop(0))
    if not rest:
        _refuse()
    return files, kind, rest


def _coverage_descriptor() -> int | None:
    """The descriptor for the coverage; None if it is not asked for."""
    value = os.environ.pop("HRDSL_COVERAGE_FD", None)
    if value is None:
        return None
    try:
        # What the program starts must not hold it open.
        os.set_inheritable(int(value), False)
        return int(value)
    except (ValueError, OSError):
        _refuse("hrdsl: HRDSL_COVERAGE_FD is %s, which is no open descriptor\n" % value)


def _refuse(why: str = "") -> NoReturn:
    sys.stderr.write(why + USAGE)
    sys.exit(2)


def _search_path() -> None:
    given = os.environ.pop("HRDSL_SYS_PATH", "")
    sys.path.extend(folder for folder in given.split(os.pathsep) if folder and folder not in sys.path)
    if not hasattr(builtins, "exit"):  # the interpreter was started without `site`, which is slow
        import _sitebuiltins

        builtins.exit = _sitebuiltins.Quitter("exit", "Ctrl-D")
        builtins.quit = _sitebuiltins.Quitter("quit", "Ctrl-D")


def _terminated(number: int, frame: Any) -> None:
    raise Stopped("terminated")


def _switch() -> Switch | None:
    """What puts a mutant in the place of a file, if one is run (`hrdsl.mutated`)."""
    words = os.environ.pop("HRDSL_MUTANT", None)
    if words is None:
        return None
    from hrdsl import mutated

    switch = mutated.chosen(words)
    finder: Any = switch
    sys.meta_path.insert(0, finder)
    return switch


def _run(run: PreparedRun, switch: Switch | None) -> None:
    words, option, recorder = run.words, run.option, run.recorder
    if option == "-c":
        _execute(compile(words[0], "<string>", "exec", dont_inherit=True), None, recorder)
    elif not option:
        path = os.path.abspath(words[0])
        code = (switch and switch.code_for(path)) or run.compiled or _compiled(path)
        _execute(code, path, recorder)
    else:
        import runpy

        sys.path.insert(0, os.getcwd())
        if recorder is not None:
            recorder.start()
        runpy.run_module(words[0], run_name="__main__", alter_sys=True)


def _compiled(path: str) -> Any:
    with open(path, "rb") as file:
        return compile(file.read(), path, "exec", dont_inherit=True)


def _execute(code: Any, path: str | None, recorder: Recorder | None) -> None:
    """Runs code as `__main__`, which is at this path, or came as a word of the command."""
    sys.path.insert(0, "" if path is None else os.path.dirname(path))
    script = type(sys)("__main__")
    if path is not None:
        script.__file__ = path
    script.__dict__["__builtins__"] = builtins
    sys.modules["__main__"] = script
    if recorder is not None:
        recorder.start()
    exec(code, script.__dict__)


def _check_use(words: list[str], option: str) -> None:
    """A program that was to be a node, and has ended without a word: a file that only defines what would be one says so."""
    if option == "-c" or "HRDSL_MIDDLEWARE" not in os.environ:
        return
    path: str | None = words[0]
    if option == "-m":
        from importlib.util import find_spec

        spec = find_spec(words[0])
        path = spec.origin if spec else None
    if path is None or not os.path.isfile(path):
        return
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    if "def main(" not in text or text.count("main(") > 1:
        return
    call = "python3 -c 'from %s import main; main()'" % words[0] if option else 'if __name__ == "__main__": main()'
    told = "hrdsl: %s defines main(), and nobody calls it: %s"
    sys.exit(told % (words[0], ("start it with `%s`" if option else "its last line would be `%s`") % call))


def _middleware() -> None:
    """Puts what stands for the client libraries of ROS where they are found after the program's own modules, whose folder comes
    before it."""
    name = os.environ.get("HRDSL_MIDDLEWARE")
    if name:
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), name))
    if name or "HRDSL_BINDING" in os.environ:
        from hrdsl import interfaces

        interfaces.install()


def _status(run: Callable[[], object]) -> tuple[int, bool]:
    """Runs a part of the program, and says with which status it has ended, and whether because the test is over."""
    try:
        run()
        return 0, False
    except Stopped:
        return 0, True
    except SystemExit as end:
        if end.code is None or end.code == 0:
            return 0, False
        if isinstance(end.code, int):
            return end.code, False
        sys.stderr.write("%s\n" % (end.code,))
        return 1, False
    except BaseException as error:
        if debug.has_left(error):
            sys.stderr.write("hrdsl: the debugger was left, which ends the program\n")
            return 1, True
        trace = error.__traceback__
        while trace is not None and trace.tb_frame.f_globals.get("__name__") == __name__:
            trace = trace.tb_next  # the script's own frames only
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        told.ended_by(error)
        found = told.place_of(error)
        if found:
            sys.stderr.write("hrdsl: it was raised in a callback of the node %s: %s\n" % found)
        if isinstance(error, ImportError):
            _advise(error)
        return 1, False


def _advise(error: ImportError) -> None:
    try:
        from hrdsl import advice

        line = advice.about(error)
    except Exception:  # the traceback above says what matters
        return
    if line:
        sys.stderr.write("hrdsl: %s\n" % line)


def _join_threads() -> None:
    """As at the interpreter's end, but while simulated time can still pass."""
    threading: Any = sys.modules.get("threading")
    if threading is not None:
        threading._shutdown()
