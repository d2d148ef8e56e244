"""All mutants of a source, in its order, and which of them are needless."""

from __future__ import annotations

import ast
import difflib
import types

from hrdsl.mutation import robots, usual
from hrdsl.mutation.mutant import Edit, Mutant, applied, changed_lines, walk

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Iterable, Iterator

    from hrdsl.mutation.mutant import Path

_FUNCTION = (ast.FunctionDef, ast.AsyncFunctionDef)


class UnknownOperator(ValueError):
    """No operator has this name."""


def operators() -> list[str]:
    """The names of all operators."""
    return [*usual.OPERATORS, *robots.OPERATORS, *robots.WIDER]


def check_operators(names: Iterable[str]) -> None:
    """Raises `UnknownOperator` with the nearest name if one of them is none."""
    for name in names:
        if name not in operators():
            near = difflib.get_close_matches(name, operators(), 1)
            hint = "did you mean `%s`?" % near[0] if near else "there are: %s" % ", ".join(operators())
            raise UnknownOperator("no operator is named `%s`; %s" % (name, hint))


def mutants(source: str, file: str = "<source>", only: Iterable[str] = (), marked: bool = True) -> list[Mutant]:
    """All mutants of a source, or those of some operators; `marked`: each is marked if it is not worth a run, which takes a
    compilation of each.

    Raises `SyntaxError` if the source has one, and `UnknownOperator`."""
    wanted = list(only)
    check_operators(wanted)
    tree = ast.parse(source, file)
    changes = sorted(_changes(tree), key=lambda change: change[1])
    found = [Mutant(number, operator, line, what, edits) for number, (operator, line, what, edits) in enumerate(changes, 1)]
    for mutant in found:
        mutant.lines = sorted({line for edit in mutant.edits for line in changed_lines(tree, edit)}) or [mutant.line]
    if marked:
        _mark(tree, file, found)
    return [mutant for mutant in found if not wanted or mutant.operator in wanted]


def code(tree: ast.Module, file: str, mutant: Mutant) -> types.CodeType:
    """The tree of a source with the mutant, compiled as if it were the file, so that lines and tracebacks are those of the file."""
    return compile(applied(tree, mutant.edits), file, "exec", dont_inherit=True)


def _changes(tree: ast.Module) -> Iterator[tuple[str, int, str, list[Edit]]]:
    places = robots.places_of(tree)
    single = {**usual.OPERATORS, **robots.OPERATORS, "place": lambda node: robots.place(node, places)}
    nodes = [(path, node) for path, node in walk(tree) if not _is_left_out(path)]
    for path, node in nodes:
        line = getattr(node, "lineno", 1)
        for name, operator in single.items():
            for new, what in operator(node):
                yield name, line, what, [Edit(path, [new])]
        for field in ("body", "orelse", "finalbody"):
            body = getattr(node, field, None)
            if isinstance(body, list):
                for index, statement in enumerate(body):
                    for name, edits, what in robots.steps(path + ((field, index),), body, index):
                        yield name, statement.lineno, what, edits
        if isinstance(node, _FUNCTION):
            for name, edits, what, line in robots.percepts(list(_own(node, path))):
                yield name, line, what, edits


def _own(function: ast.AST, path: Path) -> Iterator[tuple[Path, ast.AST]]:
    """The nodes of a function without those of functions in it, which have their own turn."""
    inner: list[Path] = []
    for at, node in walk(function, path):
        if any(at[: len(p)] == p for p in inner):
            continue
        if isinstance(node, _FUNCTION) and at != path:
            inner.append(at)
            continue
        yield at, node


def _is_left_out(path: Path) -> bool:
    """Whether a node is in a decorator, an annotation or a format: their changes mean nothing or do not compile."""
    return any(field in ("decorator_list", "annotation", "returns", "format_spec") for field, _ in path)


def _mark(tree: ast.Module, file: str, found: list[Mutant]) -> None:
    seen = {_bytecode(compile(tree, file, "exec", dont_inherit=True)): "equivalent"}
    for mutant in found:
        try:
            compiled = _bytecode(compile(applied(tree, mutant.edits), file, "exec", dont_inherit=True))
        except (SyntaxError, ValueError):
            mutant.needless = "invalid"
            continue
        mutant.needless = seen.get(compiled, "")
        seen.setdefault(compiled, "duplicate")


def _bytecode(value: object) -> object:
    """What decides how code behaves, without lines and columns; constants with their types, since `1 == True == 1.0`."""
    if isinstance(value, types.CodeType):
        rest = (value.co_name, value.co_flags, value.co_argcount, value.co_kwonlyargcount, value.co_names, value.co_varnames)
        handlers = getattr(value, "co_exceptiontable", b"")
        return (value.co_code, handlers, *rest, value.co_freevars, value.co_cellvars, _bytecode(value.co_consts))
    if isinstance(value, (tuple, frozenset)):
        items = [_bytecode(item) for item in value]
        return (type(value), frozenset(items) if isinstance(value, frozenset) else tuple(items))
    return (type(value), repr(value))
