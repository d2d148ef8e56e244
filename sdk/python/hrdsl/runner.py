"""Runs a script as `__main__` with simulated time, seeded chance and, if asked, coverage.

    python -m hrdsl.run [--coverage FILE]... [--coverage-out OUT] (script.py | -m module) args...

The environment has HRDSL_SEED, the two descriptors of the protocol, and optionally HRDSL_SYS_PATH (folders to search
for modules), HRDSL_COVERAGE_PACKAGE (the folder that has coverage.py) and HRDSL_COVERAGE_CACHE.
"""

import _signal
import builtins
import os
import sys

from hrdsl import link as _links
from hrdsl import virtual
from hrdsl.errors import ProtocolError, Stopped

USAGE = "usage: python -m hrdsl.run [--coverage FILE]... [--coverage-out OUT] (script.py | -m module) args...\n"


def main(argv):
    """Never returns: exits with 0 at a normal end or a stop, with 1 after an uncaught exception."""
    files, out, module, words = _arguments(argv)
    _search_path()
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(line_buffering=True)
    try:
        link = _links.the_link()
    except ProtocolError as error:
        sys.exit("hrdsl: %s" % error)
    _signal.signal(_signal.SIGTERM, _terminated)
    recorder = None
    if files and out:
        from hrdsl.cover import Recorder

        environment = os.environ.get
        recorder = Recorder(files, environment("HRDSL_COVERAGE_PACKAGE"), environment("HRDSL_COVERAGE_CACHE"))
    virtual.install(link, int(os.environ.get("HRDSL_SEED", "0")))
    status = 1
    try:
        status = _run(words, module, recorder)
        if status == 0 and not link.stopped:
            link.done()
    finally:
        _signal.signal(_signal.SIGTERM, _signal.SIG_IGN)
        if recorder is not None:
            _save(recorder, out)
    sys.exit(status)


def _save(recorder, out):
    try:
        recorder.stop()
        recorder.write(out)
    except Exception as error:  # no coverage is no reason to call the program's run a failure
        sys.stderr.write("hrdsl: coverage was not written: %r\n" % error)


def _arguments(argv):
    files, out, module, rest = [], None, False, list(argv)
    while rest and rest[0].startswith("-"):
        option = rest.pop(0)
        if option == "-m":
            module = True
            break
        if option not in ("--coverage", "--coverage-out") or not rest:
            sys.stderr.write(USAGE)
            sys.exit(2)
        if option == "--coverage":
            files.append(rest.pop(0))
        else:
            out = rest.pop(0)
    if not rest:
        sys.stderr.write(USAGE)
        sys.exit(2)
    return files, out, module, rest


def _search_path():
    given = os.environ.pop("HRDSL_SYS_PATH", "")
    sys.path.extend(folder for folder in given.split(os.pathsep) if folder and folder not in sys.path)
    if not hasattr(builtins, "exit"):  # the interpreter was started without `site`, which is slow
        import _sitebuiltins

        builtins.exit = _sitebuiltins.Quitter("exit", "Ctrl-D")
        builtins.quit = _sitebuiltins.Quitter("quit", "Ctrl-D")


def _terminated(number, frame):
    raise Stopped("terminated")


def _run(words, module, recorder):
    """Runs the script, and says with which status it ended."""
    sys.argv = list(words)
    try:
        if module:
            import runpy

            sys.path.insert(0, os.getcwd())
            if recorder is not None:
                recorder.start()
            runpy.run_module(words[0], run_name="__main__", alter_sys=True)
        else:
            _script(words[0], recorder)
        _join_threads()
        return 0
    except SystemExit as end:
        if end.code is None or end.code == 0:
            return 0
        if isinstance(end.code, int):
            return end.code
        sys.stderr.write("%s\n" % (end.code,))
        return 1
    except BaseException as error:
        trace = error.__traceback__
        while trace is not None and trace.tb_frame.f_globals.get("__name__") == __name__:
            trace = trace.tb_next  # the script's own frames only
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        if isinstance(error, ModuleNotFoundError):
            _advise(error)
        return 1


def _advise(error):
    try:
        from hrdsl import advice

        line = advice.about(error)
    except Exception:  # the traceback above says what matters
        return
    if line:
        sys.stderr.write("hrdsl: %s\n" % line)


def _script(path, recorder):
    path = os.path.abspath(path)
    with open(path, "rb") as file:
        text = file.read()
    code = compile(text, path, "exec", dont_inherit=True)
    sys.path.insert(0, os.path.dirname(path))
    script = type(sys)("__main__")
    script.__file__ = path
    script.__builtins__ = builtins
    sys.modules["__main__"] = script
    if recorder is not None:
        recorder.start()
    exec(code, script.__dict__)


def _join_threads():
    threading = sys.modules.get("threading")
    if threading is None:
        return
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()
