"""The operators for robot code: times, thresholds, deadlines, messages, percepts, steps, checks and places."""

from __future__ import annotations

import ast
import re

from hrdsl.mutation.mutant import Edit
from hrdsl.mutation.usual import is_number, like

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Iterator, Union

    from hrdsl.mutation.mutant import Path

    Change = tuple[ast.AST, str]
    Function = Union[ast.FunctionDef, ast.AsyncFunctionDef]

_TIME = re.compile(r"time|timeout|deadline|duration|delay|period|rate|pause|wait|settle|window|sleep|seconds", re.I)
_PLACE = re.compile(r"place|pose|posture|position|target|goal|waypoint|home", re.I)
_READ = re.compile(r"^(read|get|sense|measure|is|see|look|hear|state|ranges|poll)(_|$)", re.I)
_FACTORS = ((0.5, "halved"), (2.0, "doubled"))
_LATE = 1.0  # seconds by which a call is delayed


def called(node: ast.AST) -> str:
    """The last name of what a call calls, or ""."""
    if not isinstance(node, ast.Call):
        return ""
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    return node.func.id if isinstance(node.func, ast.Name) else ""


def is_step(node: ast.AST) -> bool:
    """Whether it is a statement that only calls; logging is not what a robot does."""
    if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
        return False
    func = node.value.func
    logs = isinstance(func, ast.Attribute) and isinstance(func.value, ast.Name) and func.value.id in ("log", "logger", "logging")
    return not logs and called(node.value) not in ("print", "add_argument", "basicConfig")


def scaled(value: ast.AST, factor: float) -> ast.AST:
    if isinstance(value, ast.Constant):
        return like(ast.Constant(value.value * factor), value)
    return like(ast.BinOp(value, ast.Mult(), ast.Constant(factor)), value)


def time(node: ast.AST) -> Iterator[Change]:
    """Times halved and doubled: constants with such a name, and what `sleep`, `Rate` and the like are given."""
    if isinstance(node, ast.Assign) and is_number(node.value):
        if any(isinstance(target, ast.Name) and _TIME.search(target.id) for target in node.targets):
            for factor, how in _FACTORS:
                yield like(ast.Assign(node.targets, scaled(node.value, factor)), node), "the time is " + how
    elif called(node).lower() in ("sleep", "rate", "duration") and len(node.args) == 1:
        for factor, how in _FACTORS:
            yield like(ast.Call(node.func, [scaled(node.args[0], factor)], node.keywords), node), "the time is " + how


def threshold(node: ast.AST) -> Iterator[Change]:
    """What a reading is compared with, a tenth lower and higher."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], (ast.Lt, ast.LtE, ast.Gt, ast.GtE)):
        bound = node.comparators[0]
        named = isinstance(bound, ast.Name) and bound.id.isupper()
        if is_number(bound) or named:
            for factor, how in ((0.9, "lower"), (1.1, "higher")):
                yield like(ast.Compare(node.left, node.ops, [scaled(bound, factor)]), node), "the threshold is a tenth " + how


def deadline(node: ast.AST) -> Iterator[Change]:
    """Deadlines dropped: a call without its `timeout=`."""
    if isinstance(node, ast.Call):
        kept = [word for word in node.keywords if word.arg not in ("timeout", "timeout_sec", "deadline")]
        if len(kept) < len(node.keywords):
            yield like(ast.Call(node.func, node.args, kept), node), "the deadline is dropped"


def check(node: ast.AST) -> Iterator[Change]:
    """Checks dropped: a guard is always met, or never; one part of it is not asked."""
    if isinstance(node, ast.If):
        for value in (True, False):
            yield like(ast.If(like(ast.Constant(value), node.test), node.body, node.orelse), node), "the check is always %s" % value
    elif isinstance(node, ast.BoolOp) and len(node.values) > 1:
        for index in range(len(node.values)):
            left = node.values[:index] + node.values[index + 1 :]
            new = left[0] if len(left) == 1 else like(ast.BoolOp(node.op, left), node)
            yield new, "part %d of the check is not asked" % (index + 1)


def dropped(node: ast.AST) -> Iterator[Change]:
    if is_step(node):
        yield like(ast.Pass(), node), "%s is not called" % (called(node.value) or "the function")


def _sleep(node: ast.stmt) -> ast.AST:
    module = ast.Call(ast.Name("__import__", ast.Load()), [ast.Constant("time")], [])
    return like(ast.Expr(ast.Call(ast.Attribute(module, "sleep", ast.Load()), [ast.Constant(_LATE)], [])), node)


def steps(path: Path, body: list[ast.stmt], index: int) -> Iterator[tuple[str, list[Edit], str]]:
    """Calls delayed, doubled, and exchanged with the next; `path` is that of the statement."""
    node = body[index]
    if not is_step(node):
        return
    name = called(node.value) or "the function"  # type: ignore[attr-defined]
    yield "delayed", [Edit(path, [_sleep(node), node])], "%s is called %g s late" % (name, _LATE)
    yield "doubled", [Edit(path, [node, node])], "%s is called twice" % name
    if index + 1 < len(body) and isinstance(body[index + 1], (ast.Expr, ast.Assign)):
        yield "reordered", [Edit(path, [body[index + 1], node], 2)], "%s is called after the next statement" % name


def _is_reading(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and bool(_READ.match(node.func.attr))


def percepts(found: list[tuple[Path, ast.AST]]) -> Iterator[tuple[str, list[Edit], str, int]]:
    """Readings of one function: neighbours exchanged, and each one left at the value of the call before. `found` are a function's nodes."""
    readings = [(path, node) for path, node in found if _is_reading(node)]
    for (path, node), (other_path, other) in zip(readings, readings[1:]):
        within = other_path[: len(path)] == path or path[: len(other_path)] == other_path
        if not within and ast.dump(node) != ast.dump(other):
            yield "swapped", [Edit(path, [other]), Edit(other_path, [node])], "%s and %s are swapped" % (called(node), called(other)), node.lineno
    fields = _fields(found)
    for (path, node), (other_path, other) in zip(fields, fields[1:]):
        if ast.dump(node.value) == ast.dump(other.value) and node.attr != other.attr:
            what = "%s.%s and .%s are swapped" % (node.value.id, node.attr, other.attr)  # type: ignore[attr-defined]
            yield "swapped", [Edit(path, [other]), Edit(other_path, [node])], what, node.lineno
    for path, node in readings:
        yield "stale", [Edit(path, [_previous(node)])], "%s gives its value of the call before" % called(node), node.lineno


def _fields(found: list[tuple[Path, ast.AST]]) -> list[tuple[Path, ast.Attribute]]:
    """What is read of the function's own variables and parameters, in its order: an answer has several percepts."""
    own = {node.id for _, node in found if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    own |= {node.arg for _, node in found if isinstance(node, ast.arg) and node.arg != "self"}
    return [
        (path, node)
        for path, node in found
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load)
        if isinstance(node.value, ast.Name) and node.value.id in own and path[-1][0] != "func"
    ]


def _previous(node: ast.AST) -> ast.AST:
    """The value of the call before is kept among the module's names, by place: all instances and threads share it."""
    key = "_hrdsl_stale_%d_%d" % (node.lineno, node.col_offset)  # type: ignore[attr-defined]
    source = "(lambda now, names: (names.setdefault(%r, now), names.__setitem__(%r, now))[0])(0, globals())" % (key, key)
    call = ast.parse(source, mode="eval").body
    assert isinstance(call, ast.Call)
    call.args[0] = node  # type: ignore[call-overload]
    return like(call, node)


def place(node: ast.AST, places: list[str]) -> Iterator[Change]:
    """Another place of the program, where one is named in a call."""
    if isinstance(node, ast.Call):
        for index, arg in enumerate(node.args):
            if isinstance(arg, ast.Name) and arg.id in places:
                other = places[(places.index(arg.id) + 1) % len(places)]
                if other != arg.id:
                    args = node.args[:index] + [like(ast.Name(other, ast.Load()), arg)] + node.args[index + 1 :]
                    yield like(ast.Call(node.func, args, node.keywords), node), "%s becomes %s" % (arg.id, other)


def places_of(tree: ast.Module) -> list[str]:
    """Constants of the module that are tuples or lists of numbers and named as places are, all of one length next to each other."""
    found = []
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, (ast.Tuple, ast.List)):
            if all(is_number(item) for item in node.value.elts):
                found += [(len(node.value.elts), t.id) for t in node.targets if isinstance(t, ast.Name) and _PLACE.search(t.id)]
    most = max((length for length, _ in found), key=[length for length, _ in found].count, default=0)
    return [name for length, name in found if length == most]


OPERATORS = {"time": time, "threshold": threshold, "deadline": deadline, "check": check, "dropped": dropped}
#: Operators that look at more than one node.
WIDER = ("delayed", "doubled", "reordered", "swapped", "stale", "place")
