"""What a mutant is, and how it is put into a tree."""

from __future__ import annotations

import ast
import copy

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Iterator, Union

    #: The way from the root to a node: fields, with an index in those that are lists.
    Path = tuple[tuple[str, Union[int, None]], ...]
    #: The line and column of a node, and those of its end.
    _Place = tuple[int, int, int, int]


class Edit:
    """At `path`, `count` nodes give way to `nodes`; count and length are 1 except in lists of statements."""

    def __init__(self, path: Path, nodes: list[ast.AST], count: int = 1) -> None:
        self.path = path
        self.nodes = nodes
        self.count = count


class Mutant:
    """One change of one source. `number` counts all mutants of the source, whichever operators were asked for."""

    def __init__(self, number: int, operator: str, line: int, what: str, edits: list[Edit]) -> None:
        self.number = number
        self.operator = operator
        self.line = line
        #: Where the statements begin that it changes: a run that executes none of these lines cannot differ.
        self.lines = [line]
        self.what = what
        self.edits = edits
        #: "equivalent" to the original, "duplicate" of an earlier mutant, "invalid" if it does not compile, or "".
        self.needless = ""

    def __repr__(self) -> str:
        return "<Mutant %d: line %d, %s: %s>" % (self.number, self.line, self.operator, self.what)


def applied(tree: ast.Module, edits: list[Edit]) -> ast.Module:
    """The tree with the edits; it shares what they leave alone. Edits must not lie within each other."""
    for edit in edits:
        tree = _replaced(tree, edit.path, edit, (1, 0, 1, 0))
    return tree


def _replaced(node: Any, path: Path, edit: Edit, place: _Place) -> Any:
    """`place` is that of the last node above that has one."""
    (field, index), rest = path[0], path[1:]
    changed = copy.copy(node)
    place = _place(node, place)
    value = getattr(node, field)
    if not rest:
        for new in edit.nodes:
            _locate(new, place)
    if index is None:
        setattr(changed, field, _replaced(value, rest, edit, place) if rest else edit.nodes[0])
        return changed
    items = list(value)
    if rest:
        items[index] = _replaced(items[index], rest, edit, place)
    else:
        items[index : index + edit.count] = edit.nodes
    setattr(changed, field, items)
    return changed


def _place(node: Any, above: _Place) -> _Place:
    if not hasattr(node, "lineno"):
        return above
    return (node.lineno, node.col_offset, node.end_lineno, node.end_col_offset)


def _locate(node: Any, place: _Place) -> None:
    """Gives places to new nodes that have none, as `ast.fix_missing_locations` does for a whole tree, which takes longer than to compile it."""
    if "lineno" in node._attributes:
        for name, value in zip(("lineno", "col_offset", "end_lineno", "end_col_offset"), place):
            if getattr(node, name, None) is None:
                setattr(node, name, value)
        place = _place(node, place)
    for child in ast.iter_child_nodes(node):
        _locate(child, place)


def changed_lines(tree: ast.Module, edit: Edit) -> list[int]:
    """Where the statements (or handlers of exceptions) begin that an edit changes."""
    node: Any = tree
    line = 0
    siblings: list[Any] = []
    for field, index in edit.path:
        value = getattr(node, field)
        siblings = [] if index is None else value[index : index + edit.count]
        node = value if index is None else value[index]
        if isinstance(node, (ast.stmt, ast.excepthandler)):
            line = node.lineno
    wider = [item.lineno for item in siblings if isinstance(item, ast.stmt)]
    return wider or ([line] if line else [])


def walk(node: ast.AST, path: Path = ()) -> Iterator[tuple[Path, ast.AST]]:
    """Every node with its path, in the order of the source."""
    yield path, node
    for field, value in ast.iter_fields(node):
        if isinstance(value, ast.AST):
            yield from walk(value, path + ((field, None),))
        elif isinstance(value, list):
            for index, item in enumerate(value):
                if isinstance(item, ast.AST):
                    yield from walk(item, path + ((field, index),))
