"""Runs a program with one mutant: in this process, without writing a file."""

from __future__ import annotations

import atexit
import importlib.abc
import importlib.util
import os
import runpy
import sys
import types

from hrdsl.mutation.found import code, mutants

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Callable, Sequence


#: The number of the mutant that raises at once: tests that do not notice it measure nothing.
SENTINEL = 0


class Switch(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Gives the mutated code for the module that is in the file."""

    def __init__(self, file: str, compiled: types.CodeType) -> None:
        self.file = os.path.realpath(file)
        self.compiled = compiled
        self.is_used = False

    def find_spec(self, name: str, path: Sequence[str] | None, target: types.ModuleType | None = None) -> object:
        stem, _ = os.path.splitext(os.path.basename(self.file))
        last = name.rpartition(".")[2]
        is_package = stem == "__init__"
        if last != (os.path.basename(os.path.dirname(self.file)) if is_package else stem):
            return None
        inner = os.path.join(last, "__init__.py") if is_package else stem + ".py"
        for folder in sys.path if path is None else path:
            if os.path.realpath(os.path.join(folder or ".", inner)) == self.file:
                inside = [os.path.dirname(self.file)] if is_package else None
                return importlib.util.spec_from_file_location(name, self.file, loader=self, submodule_search_locations=inside)
        return None

    def create_module(self, spec: object) -> None:
        return None

    def exec_module(self, module: types.ModuleType) -> None:
        self.is_used = True
        exec(self.compiled, module.__dict__)  # the program's own code


def switched(file: str, number: int, program: list[str]) -> Callable[[], None]:
    """What runs `program` (a file and its arguments) as `python` would, with mutant `number` of `file`; it raises what the
    program raises, so that nobody takes that for a fault of the file.

    Raises `OSError`, `SyntaxError`, and `LookupError` if there is no such mutant."""
    with open(file, encoding="utf-8") as source:
        text = source.read()
    if number == SENTINEL:
        compiled = compile("raise RuntimeError('the sentinel mutant ends at once')", file, "exec")
    else:
        found = {mutant.number: mutant for mutant in mutants(text, file)}
        if number not in found:
            raise LookupError("%s has mutants 1 to %d, not %d; `list` shows them" % (file, len(found), number))
        compiled = code(text, file, found[number])
    return lambda: _run(file, compiled, program)


def _run(file: str, compiled: types.CodeType, program: list[str]) -> None:
    sys.argv = list(program)
    sys.path[0] = os.path.dirname(os.path.abspath(program[0]))
    if os.path.realpath(program[0]) != os.path.realpath(file):
        switch = Switch(file, compiled)
        sys.meta_path.insert(0, switch)
        atexit.register(_say_if_unused, switch)
        runpy.run_path(program[0], run_name="__main__")
        return
    main = types.ModuleType("__main__")
    main.__file__ = program[0]
    sys.modules["__main__"] = main
    exec(compiled, main.__dict__)  # the program's own code


def _say_if_unused(switch: Switch) -> None:
    """Who sees the original run must not take it for a mutant that nobody notices."""
    if not switch.is_used:
        print("error: the program did not import %s, so that its mutant changed nothing" % switch.file, file=sys.stderr)
