"""Runs a program with one mutant: in this process, without writing a file."""

from __future__ import annotations

import ast
import atexit
import marshal
import os
import runpy
import sys
import types

from hrdsl.mutated import Switch
from hrdsl.mutation.found import code, mutants

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Callable, Iterable


#: The number of the mutant that raises at once: tests that do not notice it measure nothing.
SENTINEL = 0


def codes(file: str, numbers: Iterable[int], to: str) -> None:
    """Compiles mutants of a file, each to `NUMBER.code` in the folder `to`, as `hrdsl.mutated` reads them; and the file as it is, to
    `original.code`.

    Raises `OSError`, `SyntaxError`, and `LookupError` if there is no such mutant."""
    with open(file, encoding="utf-8") as source:
        text = source.read()
    found = {mutant.number: mutant for mutant in mutants(text, file, marked=False)}
    tree = ast.parse(text, file)
    compiled = {str(number): _compiled(tree, file, number, found) for number in numbers}
    compiled["original"] = compile(text, file, "exec", dont_inherit=True)
    for name, each in compiled.items():
        with open(os.path.join(to, name + ".code"), "wb") as out:
            out.write(marshal.dumps(each))


def switched(file: str, number: int, program: list[str]) -> Callable[[], None]:
    """What runs `program` (a file and its arguments) as `python` would, with mutant `number` of `file`; it raises what the
    program raises, so that nobody takes that for a fault of the file.

    Raises `OSError`, `SyntaxError`, and `LookupError` if there is no such mutant."""
    with open(file, encoding="utf-8") as source:
        text = source.read()
    found = {} if number == SENTINEL else {mutant.number: mutant for mutant in mutants(text, file, marked=False)}
    compiled = _compiled(ast.parse(text, file), file, number, found)
    return lambda: _run(file, compiled, program)


def _compiled(tree: ast.Module, file: str, number: int, found: dict[int, object]) -> types.CodeType:
    if number == SENTINEL:
        return compile("raise RuntimeError('the sentinel mutant ends at once')", file, "exec")
    if number not in found:
        raise LookupError("%s has mutants 1 to %d, not %d; `list` shows them" % (file, len(found), number))
    return code(tree, file, found[number])  # type: ignore[arg-type]


def _run(file: str, compiled: types.CodeType, program: list[str]) -> None:
    sys.argv = list(program)
    sys.path[0] = os.path.dirname(os.path.abspath(program[0]))
    if os.path.realpath(program[0]) != os.path.realpath(file):
        switch = Switch(file, compiled)
        sys.meta_path.insert(0, switch)  # type: ignore[arg-type]
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
