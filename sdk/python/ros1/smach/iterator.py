"""`Iterator`: one state, executed for each of some items."""

from __future__ import annotations

import smach
from smach import _told
from smach.container import Container, trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["Iterator"]


class Iterator(Container):
    """Runs its state for each item, until the items are exhausted or an outcome breaks the loop."""

    def __init__(
        self,
        outcomes: list[str],
        input_keys: list[str],
        output_keys: list[str],
        it: Any = [],
        it_label: str = "it_data",
        exhausted_outcome: str = "exhausted",
    ) -> None:
        if exhausted_outcome not in outcomes:
            outcomes.append(exhausted_outcome)
        Container.__init__(self, outcomes, input_keys, output_keys)
        self._items = it
        self._items_label = it_label
        self._is_running = False
        self._state_label: Any = ""
        self._state: Any = None
        self._loop_outcomes: list[str] = []
        self._break_outcomes: list[str] = []
        self._final_outcome_map: dict[str, str] = {}
        self._exhausted_outcome = exhausted_outcome

    @staticmethod
    def set_iteritems(it: Any, it_label: str = "it_data") -> None:
        """What to iterate over (or a function that returns it), and the key that has the item."""
        self = Iterator._currently_opened_container()
        self._items, self._items_label = it, it_label

    @staticmethod
    def set_contained_state(
        label: Any,
        state: Any,
        loop_outcomes: list[str] = [],
        break_outcomes: list[str] = [],
        final_outcome_map: dict[str, str] = {},
    ) -> None:
        """The state, which of its outcomes go on with the next item and which do not, and what becomes of the last."""
        self = Iterator._currently_opened_container()
        self._state_label, self._state = label, state
        outcomes = state.get_registered_outcomes()
        if loop_outcomes and break_outcomes:
            smach.logwarn("Both loop_outcomes and break_outcomes were specified when constructing SMACH iterator container.")
        if break_outcomes:
            self._break_outcomes = break_outcomes
            self._loop_outcomes += [outcome for outcome in outcomes if outcome not in break_outcomes]
        else:
            self._loop_outcomes = loop_outcomes
            self._break_outcomes += [outcome for outcome in outcomes if outcome not in loop_outcomes]
        self._final_outcome_map = final_outcome_map

    def execute(self, parent_ud: Any = None) -> Any:
        """Runs the state for each item, and returns the last outcome, mapped."""
        self._is_running = True
        self._copy_input_keys(parent_ud, self.userdata)
        _told.begins(self)
        self.call_start_cbs()
        outcome = self._iterate()
        if outcome in self._final_outcome_map:
            outcome = self._final_outcome_map[outcome]
        self._copy_output_keys(self.userdata, parent_ud)
        self._is_running = False
        self.call_termination_cbs(self._state_label, outcome)
        return outcome

    def _iterate(self) -> Any:
        items = iter(self._items() if callable(self._items) else self._items)
        outcome = self._exhausted_outcome
        while not smach.is_shutdown():
            try:
                item = next(items)
            except BaseException as error:
                if smach.is_the_end(error):
                    raise
                return self._exhausted_outcome  # whatever it was, as in the original
            smach.loginfo("Iterating %s of %s" % (item, self._items))
            self.userdata[self._items_label] = item
            outcome = self._run()
            if self._preempt_requested or outcome in self._break_outcomes or self._is_no_loop(outcome):
                self._preempt_requested = False
                break
            self.call_transition_cbs()
        return outcome

    def _is_no_loop(self, outcome: Any) -> bool:
        return bool(self._loop_outcomes) and outcome not in self._loop_outcomes

    def _run(self) -> Any:
        try:
            return self._state.execute(self.userdata)
        except smach.InvalidUserCodeError:
            smach.logerr("Could not execute Iterator state '%s'" % self._state_label)
            raise
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            raise smach.InvalidUserCodeError(
                "Could not execute iterator state '%s' of type '%s': %s" % (self._state_label, self._state, trace())
            ) from error

    def request_preempt(self) -> None:
        """Asks the state that runs to end, and the loop after it."""
        self._preempt_requested = True
        if self._is_running:
            self._state.request_preempt()

    # ── as a container ──

    def get_children(self) -> dict[str, Any]:
        """The one state."""
        return {self._state_label: self._state}

    def __getitem__(self, key: Any) -> Any:
        if key != self._state_label:
            smach.logerr(
                "Attempting to get state '%s' from Iterator container. The only available state is '%s'."
                % (key, self._state_label)
            )
            raise KeyError()
        return self._state

    def get_initial_states(self) -> list[str]:
        """The one state."""
        return [self._state_label]

    def set_initial_state(self, initial_states: Any, userdata: Any) -> None:
        """Only the userdata can be set: there is one state."""
        if len(initial_states) > 0 and initial_states[0] != self._state_label:
            smach.logwarn(
                "Attempting to set state '%s' as initial state in Iterator container. The only available state is '%s'."
                % (initial_states[0], self._state_label)
            )
            raise KeyError()
        self.userdata.update(userdata)

    def get_active_states(self) -> list[str]:
        """The one state, if it runs."""
        return [self._state_label] if self._is_running else []

    def get_internal_edges(self) -> list[Any]:
        """(outcome, from, to) for each outcome of the state."""
        label = self._state_label
        edges: list[Any] = [[outcome, label, label] for outcome in self._loop_outcomes]
        for outcome in self._break_outcomes:
            final = self._final_outcome_map.get(outcome, outcome)
            edges.append((outcome, label, None if final == outcome else final))
        return edges

    def check_consistency(self) -> None:
        """There is nothing that could be wrong before it runs."""
