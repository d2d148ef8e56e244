"""State machines of programs that have no library for them, declared so that their states and transitions are covered."""

from __future__ import annotations

from hrdsl.exchange import the_exchange

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Iterable, Mapping


class StateMachine:
    """What a program is doing, as one of some states; it runs nothing.

        machine = hrdsl.StateMachine("robot", {"WAIT": {"asked": "GIVE"}, "GIVE": {"given": "WAIT", "lost": "stuck"}}, ["stuck"])
        machine.begin("WAIT")
        machine.take("asked")

    `states` has for each state what its outcomes lead to, another state or one of the machine's own `outcomes`. `state` is the
    present one; None before `begin`, and when the machine has ended. Raises ValueError for what is not declared.
    """

    def __init__(self, name: str, states: Mapping[str, Mapping[str, str]], outcomes: Iterable[str] = ()) -> None:
        self.name = name
        self.state: str | None = None
        self._states = {state: dict(edges) for state, edges in states.items()}
        ends = list(outcomes)
        edges = [[state, outcome, to] for state, known in self._states.items() for outcome, to in known.items()]
        for state, outcome, to in edges:
            if to not in self._states and to not in ends:
                raise ValueError("%s: %s leads from %s to %s, which is no state and no outcome" % (name, outcome, state, to))
        self._exchange = the_exchange()
        self._exchange.declare(name, list(self._states), edges, ends)

    def begin(self, state: str) -> None:
        """Begins, or begins again, in this state."""
        if state not in self._states:
            raise ValueError("%s has no state %s; it has %s" % (self.name, state, ", ".join(self._states)))
        self.state = state
        self._exchange.begin(self.name, state)

    def take(self, outcome: str) -> str:
        """The present state has ended with this outcome: returns what that leads to."""
        if self.state is None:
            raise ValueError("%s is in no state: begin it" % self.name)
        known = self._states[self.state]
        if outcome not in known:
            outcomes = ", ".join(known) or "none"
            raise ValueError("%s has no outcome %s in %s; it has %s" % (self.name, outcome, self.state, outcomes))
        before, to = self.state, known[outcome]
        self.state = to if to in self._states else None
        self._exchange.transition(self.name, before, "", outcome, to)
        return to

    def __repr__(self) -> str:
        return "StateMachine(%r, %s)" % (self.name, self.state)
