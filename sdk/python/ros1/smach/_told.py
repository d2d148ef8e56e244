"""Tells hrdsl which machines there are and how they move, so that their states and transitions are covered.

A machine within another is called by the labels that lead to it: `machine/GRASP`. The outermost is called as in its
introspection server (`SM_ROOT`), and if it has none `machine`; further ones `machine#2` and so on, as they begin. One that is
built again in the same way has the same name.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_outermost: dict[Any, str] = {}  # names by what is declared
_told: dict[str, tuple[list[str], list[list[str]], list[str]]] = {}  # declarations by names


def is_the_end(error: BaseException) -> bool:
    """Whether it ends the program by hrdsl (the test is over, or a deadlock): no code may take it for a failure of its own."""
    return type(error).__module__ == "hrdsl.errors" and isinstance(error, SystemExit)


def _exchange() -> Any:
    """What tells hrdsl; None if it does not run this program."""
    link = getattr(sys.modules.get("hrdsl.link"), "_link", None)
    if link is None or not link.is_ours():
        return None
    from hrdsl.exchange import the_exchange

    return the_exchange()


def polled() -> None:
    """To be called where a program looks whether something has changed, so that a loop that looks lets time pass."""
    exchange = _exchange()
    if exchange is not None:
        exchange.polled("smach")


def is_child(parent: Any, label: str, state: Any) -> None:
    """The state is about to run within a container."""
    if hasattr(state, "_told_name") and state._told_name is None:
        state._told_name = "%s/%s" % (_name(parent), label)


def _name(container: Any) -> str:
    if container._told_name is None:
        shape = (type(container).__name__, *map(str, container.get_children()), *map(str, container.get_internal_edges()))
        count = len(_outermost) + 1
        container._told_name = _outermost.setdefault(shape, "machine" if count == 1 else "machine#%d" % count)
    name: str = container._told_name
    return name


def begins(container: Any) -> None:
    """The container is executed, in its initial states; the first time, what it declares is told before, and what those in it
    declare, which may never be entered."""
    name = _name(container)
    exchange = _exchange()
    if exchange is not None:
        _declare(container, exchange)
        for label in container.get_initial_states():
            exchange.begin(name, str(label))


def _declare(container: Any, exchange: Any) -> None:
    if container._is_told:
        return
    container._is_told = True
    edges = []
    for label, targets in getattr(container, "_transitions", {}).items():
        for outcome, target in targets.items():
            edges.append([str(label), str(outcome), str(target if _leads(container, target) else outcome)])
    try:
        children = container.get_children()
    except NotImplementedError:  # a container of the program's own that does not say
        children = {}
    name = _name(container)
    declared = ([str(label) for label in children], edges, [str(outcome) for outcome in container.get_registered_outcomes()])
    if _told.get(name) != declared:
        _told[name] = declared
        exchange.declare(name, *declared)
    for label, child in children.items():
        is_child(container, label, child)
        if hasattr(child, "_is_told"):
            _declare(child, exchange)


def _leads(machine: Any, target: Any) -> bool:
    return target in machine._states or target in machine.get_registered_outcomes()


def moves(machine: Any, label: str, state: Any, outcome: str, next: str) -> None:
    """The machine goes from a state to the next, or to an outcome of its own."""
    exchange = _exchange()
    if exchange is not None:
        exchange.transition(_name(machine), str(label), type(state).__name__, str(outcome), str(next))
