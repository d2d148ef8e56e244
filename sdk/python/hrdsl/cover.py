"""Measures which statements and branches of the given files a run executes.

`python -m hrdsl.cover --analyse FILE...` finds beforehand what follows from the files' text alone.

The tracer is coverage.py's own, written in C. It is loaded without the rest of that package, whose import costs more
than a whole short run; what follows from the source text alone (statements, possible branches) is found by coverage.py
once and kept in a cache, since the same file is run in hundreds of tests.
"""

from __future__ import annotations

import _imp
import _thread
import json
import os
import sys

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Iterable, NoReturn

#: Of the kept analyses.
FORMAT = 2


class Recorder:
    """Records the arcs (pairs of line numbers run one after the other) of the given files."""

    def __init__(self, files: list[str], package: str | None, cache: str | None) -> None:
        """`package` is the folder that has coverage.py, `cache` the folder of static analyses; both may be None."""
        self._files: dict[str, str] = {os.path.realpath(name): name for name in files}
        self._package = package
        self._cache = cache
        self._data: dict[str, set[int]] = {}
        self._seen: dict[str, str] = {}
        self._tracers: list[Any] = []
        self._threading: Any = None
        self._fallback: Any = None
        self._lock = _thread.allocate_lock()
        self._dispositions: dict[str, Any] = {}
        self._bits: int | None = None

    def prepare(self) -> None:
        """Does what can be done before the program begins."""
        self._module = _tracer_module(self._package)
        self._bits = (self._module and self._packing()) or 0
        if self._bits:
            import threading

            self._threading = threading
        else:
            coverage = self._import()
            self._fallback = coverage.Coverage(
                branch=True, include=list(self._files), data_file=None, config_file=False, messages=False
            )

    def start(self) -> None:
        """Starts to record, in this thread and those to come."""
        if self._bits is None:
            self.prepare()
        if self._fallback is not None:
            self._fallback.start()
            return
        self._threading.settrace(self._in_new_thread)
        self._trace(self._data)

    def stop(self) -> None:
        if self._fallback is not None:
            self._fallback.stop()
            return
        self._threading.settrace(None)
        for tracer in self._tracers:
            tracer.stop()

    def write(self, out: str | int, more: object = None) -> None:
        """Writes {file: statements, executed, branches, executed_branches} as JSON, to a file or a descriptor; and `more`, if there is
        any, on a line of its own."""
        result = {}
        arcs = self._arcs()
        for path, name in self._files.items():
            try:
                static, kept = _analysed(path, self._package, self._cache)
            except Exception as error:
                sys.stderr.write("hrdsl: no coverage of %s\n" % _why(name, error))
                continue
            try:
                _keep(static, kept)
            except OSError:
                pass  # the next run makes it again
            result[name] = combine(static, arcs.get(path, ()))
        with open(out, "w", encoding="utf-8") as file:
            # At once: `dump` would do it piece by piece, in Python.
            file.write(json.dumps(result, separators=(",", ":")))
            if more is not None:
                file.write("\n" + json.dumps(more, separators=(",", ":")))

    def _arcs(self) -> dict[str, Any]:
        if self._fallback is not None:
            data = self._fallback.get_data()
            return {path: data.arcs(path) or () for path in self._files}
        found: dict[str, Any] = {}
        for name, packed in self._data.items():
            found.setdefault(self._seen[name], set()).update(_unpack(arc, self._bits or 0) for arc in packed)
        return found

    # ── the tracer ──

    def _packing(self) -> int | None:
        """In how many bits the tracer packs a line number, which has changed between its versions: seen from a piece of
        code whose lines are known; None if it does something else."""
        self._files["<two lines>"] = ""
        data: dict[str, set[int]] = {}
        tracer = self._trace(data)
        exec(compile("\n\na = 1\nb = 2", "<two lines>", "exec"), {})
        tracer.stop()
        del self._tracers[:], self._files["<two lines>"]
        self._dispositions.clear()
        self._seen.clear()
        return next((bits for bits in (20, 28) if 3 | 4 << bits in data.get("<two lines>", ())), None)

    def _trace(self, data: dict[str, set[int]]) -> Any:
        tracer = self._module.CTracer()
        tracer.data = data
        tracer.trace_arcs = True
        tracer.should_trace = self._should_trace
        tracer.should_trace_cache = self._dispositions
        tracer.warn = lambda message, slug=None, once=False: sys.stderr.write("hrdsl: coverage: %s\n" % message)
        tracer.lock_data = self._lock.acquire
        tracer.unlock_data = self._lock.release
        tracer.file_tracers = {}
        for name in ("concur_id_func", "check_include", "should_start_context", "switch_context", "disable_plugin"):
            if hasattr(tracer, name):
                setattr(tracer, name, None)
        self._tracers.append(tracer)
        tracer.start()
        return tracer

    def _in_new_thread(self, frame: Any, event: str, arg: Any) -> Any:
        sys.settrace(None)
        self._trace(self._data)
        tracer: Any = sys.gettrace()
        return tracer(frame, event, arg)

    def _should_trace(self, name: str, frame: Any) -> Any:
        path = name if name in self._files else os.path.realpath(name)
        answer = self._module.CFileDisposition()
        answer.original_filename = answer.canonical_filename = answer.source_filename = name
        answer.trace = path in self._files
        answer.reason = ""
        answer.file_tracer = None
        answer.has_dynamic_filename = False
        if answer.trace:
            self._seen[name] = path
        return answer

    def _import(self) -> Any:
        return _coverage(self._package)


# ── the static analysis ──


def warm(files: Iterable[str], package: str | None, cache: str | None) -> bool:
    """Makes the static analyses of these files beforehand, so that no run has to. Says of each file that cannot be
    analysed why, in one line on standard error; whether there is none."""
    well = True
    for name in files:
        try:
            _keep(*_analysed(name, package, cache))
        except Exception as error:
            well = False
            sys.stderr.write("hrdsl: no coverage of %s\n" % _why(name, error))
    return well


def _why(name: str, error: Exception) -> str:
    if isinstance(error, SyntaxError):
        return "%s: line %s: %s" % (name, error.lineno or 1, error.msg)
    if isinstance(error, OSError) and error.strerror:
        other = error.filename not in (None, name)
        return "%s: %s%s" % (name, error.strerror, ": %s" % error.filename if other else "")
    return "%s: %s" % (name, " ".join(str(error).split()) or type(error).__name__)


def _analysed(path: str, package: str | None, cache: str | None) -> tuple[dict[str, Any], str | None]:
    """The analysis of a file, and where it is to be kept; None if it is there already, or not to be kept."""
    with open(path, "rb") as source:
        text = source.read()
    digest = _imp.source_hash(FORMAT, text).hex()
    version = os.path.basename(package or "")  # the folder's name tells the versions of Python and coverage.py
    kept = os.path.join(cache, "%s-%s.json" % (digest, version)) if cache else None
    if kept:
        try:
            with open(kept, encoding="utf-8") as file:
                return json.load(file), None
        except (OSError, ValueError):
            pass
    compile(text, path, "exec", dont_inherit=True)  # says more of bad syntax
    return analyse(_coverage(package), path), kept


def _keep(static: dict[str, Any], kept: str | None) -> None:
    if kept:
        temporary = "%s.%d" % (kept, os.getpid())
        with open(temporary, "w", encoding="utf-8") as file:
            json.dump(static, file, separators=(",", ":"))
        os.replace(temporary, kept)


def _coverage(package: str | None) -> Any:
    if package and package not in sys.path:
        sys.path.append(package)
    import coverage

    return coverage


def _tracer_module(package: str | None) -> Any:
    """coverage.py's C tracer, without the package around it; None if it has none for this interpreter."""
    from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, ModuleSpec

    for folder in [package] if package else sys.path:
        for suffix in EXTENSION_SUFFIXES:
            path = os.path.join(folder, "coverage", "tracer" + suffix)
            if not os.path.exists(path):
                continue
            try:
                module = _imp.create_dynamic(
                    ModuleSpec("coverage.tracer", ExtensionFileLoader("coverage.tracer", path), origin=path)
                )
                _imp.exec_dynamic(module)
                return module if hasattr(module, "CTracer") else None
            except ImportError:
                return None
    return None


def _unpack(packed: int, bits: int) -> tuple[int, int]:
    # As the tracer packs them: so many bits each, and then a bit each for the sign.
    mask = (1 << bits) - 1
    here, there = packed & mask, packed >> bits & mask
    return -here if packed >> 2 * bits & 1 else here, -there if packed >> 2 * bits + 1 & 1 else there


def analyse(coverage: Any, path: str) -> dict[str, Any]:
    """What follows from the source text alone."""
    from coverage.python import PythonFileReporter

    reporter = PythonFileReporter(path, coverage.Coverage(branch=True, data_file=None, config_file=False))
    parser = reporter.parser
    statements = reporter.lines()
    possible = reporter.arcs()
    excluded = reporter.excluded_lines()
    no_branch = reporter.no_branch_lines()
    several = {line for line, count in reporter.exit_counts().items() if count > 1 and line not in no_branch}
    # coverage.py before 7.7 has jumps within a line, for comprehensions; later ones do not.
    branches = [arc for arc in possible if arc[0] in several and arc[1] not in excluded and arc[0] != arc[1]]
    first_lines = getattr(parser, "multiline_map", None) or getattr(parser, "_multiline", {})
    jumps = getattr(parser, "_with_jump_fixers", {})
    return {
        "statements": sorted(statements),
        "branches": sorted(branches),
        "possible": sorted(possible),
        "first_lines": sorted([line, first] for line, first in first_lines.items() if line != first),
        "jumps": sorted(jumps.items(), key=lambda jump: jump[0]),
    }


def combine(static: dict[str, Any], arcs: Iterable[tuple[int, int]]) -> dict[str, Any]:
    """The static analysis and the arcs of one run, as coverage.py's reports combine them."""
    first_lines: dict[int, int] = dict(static["first_lines"])
    jumps = {_tuples(arc): _tuples(to) for arc, to in static["jumps"]}
    after: dict[int, list[int]] = {}
    for here, there in static["possible"]:
        after.setdefault(here, []).append(there)

    def first(line: int) -> int:
        return first_lines.get(line, line) if line >= 0 else -first_lines.get(-line, -line)

    def translate(arcs: Iterable[tuple[int, int]]) -> set[tuple[int, int]]:
        return {(first(here), first(there)) for here, there in _without_jumps(arcs, jumps)}

    lines = {first(line) for arc in arcs for line in arc if line > 0}
    moved = set()
    for here, there in translate((here, there) for here, there in arcs):
        if here != there:
            moved.add((here, there))
        elif len(after.get(here, ())) == 1:
            moved.add((here, after[here][0]))
    taken = translate(moved)
    return {
        "statements": static["statements"],
        "executed": [line for line in static["statements"] if line in lines],
        "branches": static["branches"],
        "executed_branches": [arc for arc in static["branches"] if tuple(arc) in taken],
    }


def _tuples(value: Any) -> Any:
    return tuple(_tuples(part) for part in value) if isinstance(value, (list, tuple)) else value


def _without_jumps(arcs: Iterable[tuple[int, int]], jumps: dict[Any, Any]) -> set[tuple[int, int]]:
    """Undoes the visits that the interpreter pays to the head of a `with` when it leaves it. coverage.py says which
    they are; up to 7.16 as arc: (next arc, last arc), in chains, then as arc: the arc in its place, or None."""
    arcs = set(arcs)
    gone: set[tuple[int, int]] = set()
    new: set[tuple[int, int]] = set()
    for arc in arcs:
        if arc not in jumps:
            continue
        gone.add(arc)
        to = jumps[arc]
        if to is None:
            continue
        if not isinstance(to[0], tuple):
            new.add(to)
            continue
        following, last = to
        while following in jumps:
            gone.add(following)
            following, last = jumps[following]
            gone.add(last)
        new.add((arc[0], last[1]))
        gone.add(following)
    return (arcs - gone) | new if _is_flat(jumps) else (arcs | new) - gone


def _is_flat(jumps: dict[Any, Any]) -> bool:
    return not any(to is not None and isinstance(to[0], tuple) for to in jumps.values())


def main(argv: list[str]) -> NoReturn:
    """`python -m hrdsl.cover --analyse [--package DIR] [--cache DIR] FILE...`: see `warm`. The folders are by default
    those that the environment gives to runs. Exits with 0 if all is well, with 1 if a file cannot be analysed."""
    folders = {"--package": os.environ.get("HRDSL_COVERAGE_PACKAGE"), "--cache": os.environ.get("HRDSL_COVERAGE_CACHE")}
    files = list(argv)
    analyse_them = files[:1] == ["--analyse"]
    del files[:1]
    while len(files) > 1 and files[0] in folders:
        folders[files[0]] = files[1]
        del files[:2]
    if not analyse_them or not files or files[0] in folders:
        sys.stderr.write("usage: python -m hrdsl.cover --analyse [--package DIR] [--cache DIR] FILE...\n")
        sys.exit(2)
    sys.exit(0 if warm(files, folders["--package"], folders["--cache"]) else 1)


if __name__ == "__main__":
    if not __package__:  # started by its path: the modules beside it are none of coverage.py's
        del sys.path[0]
    main(sys.argv[1:])
