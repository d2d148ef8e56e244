"""`Sequence`: a state machine whose states follow each other in the order in which they are added."""

from __future__ import annotations

import smach
from smach.state_machine import StateMachine

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterable

__all__ = ["Sequence"]


class Sequence(StateMachine):
    """One outcome, the connector, leads from each state to the next, unless its transitions say otherwise."""

    def __init__(
        self,
        outcomes: Iterable[str],
        connector_outcome: str,
        input_keys: list[str] = [],
        output_keys: list[str] = [],
    ) -> None:
        StateMachine.__init__(self, outcomes, input_keys, output_keys)
        self._last_added_seq_label: Any = None
        self._connector_outcome = connector_outcome

    @staticmethod
    def add(label: Any, state: Any, transitions: Any = None, remapping: Any = None) -> Any:  # type: ignore[override]
        """Adds a state to the open sequence, after the last."""
        self = Sequence._currently_opened_container()
        last = self._last_added_seq_label
        if last is not None:
            if self._transitions[last].get(self._connector_outcome) is None:
                self._transitions[last][self._connector_outcome] = label
            try:
                self.check_state_spec(last, self._states[last], self._transitions[last])
            except smach.InvalidTransitionError:
                smach.logerr("Attempting to construct smach state sequence failed.")
        self._last_added_seq_label = label
        return smach.StateMachine.add(label, state, {} if transitions is None else transitions, remapping)
