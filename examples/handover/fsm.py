"""A small finite-state machine container in the manner of SMACH.

A state is an object with a fixed set of outcomes and an `execute(userdata)` that returns one of them; the container maps
each outcome of each state to the next state, or to an outcome of its own, which ends it.
"""

import logging

log = logging.getLogger("fsm")


class InvalidTransition(Exception):
    """The machine is not consistent: an unknown state or outcome."""


class UserData:
    """The variables that states share; attributes, as in SMACH."""

    def __init__(self, **values):
        self.__dict__.update(values)


class State:
    """One state; subclasses say their outcomes and what they do."""

    def __init__(self, outcomes):
        self.outcomes = tuple(outcomes)

    def execute(self, userdata):
        raise NotImplementedError


class StateMachine:
    """States by name, and where each outcome leads."""

    def __init__(self, outcomes):
        self.outcomes = tuple(outcomes)
        self.states = {}
        self.transitions = {}
        self.initial = None

    def add(self, name, state, transitions):
        """Adds a state; the first one added is the initial one."""
        if name in self.states:
            raise InvalidTransition("state %s is added twice" % name)
        if set(transitions) != set(state.outcomes):
            raise InvalidTransition("state %s must map exactly its outcomes %s" % (name, sorted(state.outcomes)))
        self.states[name] = state
        self.transitions[name] = dict(transitions)
        if self.initial is None:
            self.initial = name

    def edges(self):
        """All transitions, as (state, outcome, next state or outcome of the machine)."""
        return [(name, outcome, to) for name, table in self.transitions.items() for outcome, to in table.items()]

    def check(self):
        """Raises `InvalidTransition` if a transition leads nowhere or there is no state."""
        if self.initial is None:
            raise InvalidTransition("the machine has no states")
        for name, outcome, to in self.edges():
            if to not in self.states and to not in self.outcomes:
                raise InvalidTransition("%s: outcome %s leads to %s, which does not exist" % (name, outcome, to))

    def execute(self, userdata):
        """Runs from the initial state until an outcome of the machine, and returns that."""
        self.check()
        current = self.initial
        while current not in self.outcomes:
            outcome = self.states[current].execute(userdata)
            if outcome not in self.transitions[current]:
                raise InvalidTransition("state %s returned %r" % (current, outcome))
            following = self.transitions[current][outcome]
            log.debug("%s --%s--> %s", current, outcome, following)
            current = following
        return current
