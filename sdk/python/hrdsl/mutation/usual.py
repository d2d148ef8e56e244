"""The operators that every library of mutations has."""

from __future__ import annotations

import ast

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Iterator

    #: What to put in the place of a node, and what that does, in words.
    Change = tuple[ast.AST, str]

_ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult}
_COMPARISON = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
}
_SIGNS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.In: "in", ast.NotIn: "not in", ast.Is: "is", ast.IsNot: "is not",
}  # fmt: skip


def is_number(node: ast.AST) -> bool:
    """Whether it is a number that is written out; `True` is none."""
    return isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) and not isinstance(node.value, bool)


def like(new: ast.AST, old: ast.AST) -> ast.AST:
    """The new node at the old one's place."""
    return ast.copy_location(new, old)


def arithmetic(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in _ARITHMETIC:
        if isinstance(node, ast.BinOp) and isinstance(node.left, ast.Constant) and isinstance(node.left.value, str):
            return  # `"%s" % x` is text
        other = _ARITHMETIC[type(node.op)]
        what = "%s becomes %s" % (_SIGNS[type(node.op)], _SIGNS[other])
        if isinstance(node, ast.BinOp):
            yield like(ast.BinOp(node.left, other(), node.right), node), what
        else:
            yield like(ast.AugAssign(node.target, other(), node.value), node), what


def comparison(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, ast.Compare):
        for index, op in enumerate(node.ops):
            for other in _COMPARISON[type(op)]:
                ops = node.ops[:index] + [other()] + node.ops[index + 1 :]
                yield like(ast.Compare(node.left, ops, node.comparators), node), "%s becomes %s" % (_SIGNS[type(op)], _SIGNS[other])


def boolean(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, ast.BoolOp):
        is_and = isinstance(node.op, ast.And)
        yield like(ast.BoolOp(ast.Or() if is_and else ast.And(), node.values), node), "and becomes or" if is_and else "or becomes and"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node.operand, "not is left out"


def constant(node: ast.AST) -> Iterator[Change]:
    if not isinstance(node, ast.Constant):
        return
    if isinstance(node.value, bool):
        yield like(ast.Constant(not node.value), node), "%r becomes %r" % (node.value, not node.value)
    elif is_number(node):
        yield like(ast.Constant(node.value + 1), node), "%r becomes %r" % (node.value, node.value + 1)
        if isinstance(node.value, int):
            yield like(ast.Constant(node.value - 1), node), "%r becomes %r" % (node.value, node.value - 1)
        else:
            yield like(ast.UnaryOp(ast.USub(), node), node), "%r becomes %r" % (node.value, -node.value)


def condition(node: ast.AST) -> Iterator[Change]:
    """Conditions of `if`, `while` and `… if … else …` negated."""
    if isinstance(node, (ast.If, ast.While, ast.IfExp)):
        test = like(ast.UnaryOp(ast.Not(), node.test), node.test)
        yield like(type(node)(test, node.body, node.orelse), node), "the condition is negated"


def returned(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, ast.Return) and node.value is not None:
        if isinstance(node.value, ast.Constant) and node.value.value is None:
            return
        yield like(ast.Return(like(ast.Constant(None), node.value)), node), "None is returned"


def removed(node: ast.AST) -> Iterator[Change]:
    """Assignments left out; calls are `call_dropped`."""
    if isinstance(node, (ast.AugAssign, ast.Delete)) or isinstance(node, ast.Assign):
        yield like(ast.Pass(), node), "the statement is left out"


def jump(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, ast.Break):
        yield like(ast.Continue(), node), "break becomes continue"
    elif isinstance(node, ast.Continue):
        yield like(ast.Break(), node), "continue becomes break"


def swallowed(node: ast.AST) -> Iterator[Change]:
    """Exceptions: what handles them does nothing, and what raises them does not."""
    if isinstance(node, ast.ExceptHandler) and not (len(node.body) == 1 and isinstance(node.body[0], ast.Pass)):
        yield like(ast.ExceptHandler(node.type, node.name, [like(ast.Pass(), node.body[0])]), node), "the exception is swallowed"
    elif isinstance(node, ast.Raise):
        yield like(ast.Pass(), node), "nothing is raised"


OPERATORS = {
    "arithmetic": arithmetic,
    "comparison": comparison,
    "boolean": boolean,
    "constant": constant,
    "condition": condition,
    "returned": returned,
    "removed": removed,
    "jump": jump,
    "swallowed": swallowed,
}
