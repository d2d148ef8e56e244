"""`Concurrence`: states that run at the same time, each in a thread of its own."""

from __future__ import annotations

import threading

import smach
from smach import _told
from smach.container import Container, trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

__all__ = ["Concurrence"]


class Concurrence(Container):
    """Ends when all its states have ended. Its outcome is what `outcome_cb` says, or else follows from theirs by the map,
    or else is the default."""

    def __init__(
        self,
        outcomes: list[str],
        default_outcome: str,
        input_keys: list[str] = [],
        output_keys: list[str] = [],
        outcome_map: dict[str, dict[str, str]] = {},
        outcome_cb: Callable[[Any], Any] | None = None,
        child_termination_cb: Callable[[Any], Any] | None = None,
    ) -> None:
        Container.__init__(self, outcomes, input_keys, output_keys)
        self._states: dict[Any, Any] = {}
        self._threads: dict[Any, threading.Thread] = {}
        self._remappings: dict[Any, Any] = {}
        if not (default_outcome or outcome_map or outcome_cb):
            raise smach.InvalidStateError("Concurrence requires an outcome policy")
        errors = ""
        if default_outcome != str(default_outcome):
            errors += "\n\tDefault outcome '%s' does not appear to be a string." % (default_outcome,)
        if default_outcome not in outcomes:
            errors += "\n\tDefault outcome '%s' is unregistered." % (default_outcome,)
        for outcome in outcome_map:
            if outcome not in outcomes:
                errors += "\n\tUnregistered outcome '%s' in and_outcome_map." % outcome
        if outcome_cb and not callable(outcome_cb):
            errors += "\n\tOutcome callback '%s' is not callable." % (outcome_cb,)
        if child_termination_cb and not callable(child_termination_cb):
            errors += "\n\tChild termination callback '%s' is not callable." % (child_termination_cb,)
        if errors:
            raise smach.InvalidStateError("Errors specifying outcome policy of concurrence: %s" % errors)
        self._default_outcome = default_outcome
        self._outcome_map = outcome_map
        self._outcome_cb = outcome_cb
        self._child_termination_cb = child_termination_cb
        self._child_outcomes: dict[Any, Any] = {}
        self._user_code_exception = False
        self._done_cond = threading.Condition()
        self._ready_event = threading.Event()

    @staticmethod
    def add(label: Any, state: Any, remapping: Any = {}) -> Any:
        """Adds a state to the open concurrence."""
        self = Concurrence._currently_opened_container()
        self._states[label] = state
        self._remappings[label] = remapping
        return state

    # ── running ──

    def execute(self, parent_ud: Any = None) -> Any:
        """Runs all states, and returns the outcome when all have ended."""
        if not self._states:
            raise smach.InvalidStateError("No states was added to concurrence")
        self._ready_event.clear()
        self._child_outcomes = {}
        self._copy_input_keys(parent_ud, self.userdata)
        smach.loginfo("Concurrence starting with userdata: \n\t%s" % (self.userdata.keys(),))
        _told.begins(self)
        self.call_start_cbs()
        self._run_all()
        if self._user_code_exception:
            self._user_code_exception = False
            raise smach.InvalidStateError("A concurrent state raised an exception during execution.")
        if self.preempt_requested() and self._preemption_was_serviced():
            smach.loginfo("Concurrence serviced preempt.")
            self.service_preempt()
            outcome: Any = "preempted"
        else:
            smach.loginfo("Concurrent Outcomes: %s" % (self._child_outcomes,))
            outcome = self._outcome()
        self._threads, self._child_outcomes = {}, {}
        self.call_termination_cbs(list(self._states), outcome)
        self._copy_output_keys(self.userdata, parent_ud)
        return outcome

    def _run_all(self) -> None:
        for label in self._states:
            self._child_outcomes[label] = None
            self._threads[label] = threading.Thread(name="concurrent_split:%s" % label, target=self._state_runner, args=(label,))
        for thread in self._threads.values():
            thread.start()
        with self._done_cond:
            self._ready_event.set()
            self._done_cond.wait()
        smach.logdebug("SMACH Concurrence preempting running states.")
        for label, state in self._states.items():
            if self._child_outcomes[label] is None:
                state.request_preempt()
        while not smach.is_shutdown() and any(thread.is_alive() for thread in self._threads.values()):
            with self._done_cond:
                self._done_cond.wait(0.1)

    def _preemption_was_serviced(self) -> bool:
        serviced = True
        for label, state in self._states.items():
            if state.preempt_requested():
                serviced = False
                smach.logwarn("State '%s' in concurrence did not service preempt." % label)
                state.recall_preempt()
        return serviced

    def _outcome(self) -> Any:
        outcome = self._default_outcome
        smach.logdebug("SMACH Concurrence determining contained state outcomes.")
        most = 0
        for mapped, needed in self._outcome_map.items():
            if all(self._child_outcomes[label] == needed[label] for label in needed):
                if len(needed) > most:
                    smach.logdebug("Terminating concurrent split with mapped outcome.")
                    outcome, most = mapped, len(needed)
                else:
                    smach.logdebug("Skipping mapped outcome '%s' with fewer constraints." % mapped)
        return self._called_outcome(outcome) if self._outcome_cb else outcome

    def _called_outcome(self, otherwise: Any) -> Any:
        assert self._outcome_cb is not None
        try:
            said = self._outcome_cb(dict(self._child_outcomes))
            if not said:
                smach.logwarn("Outcome callback returned None, using outcome '%s'" % otherwise)
            elif said == str(said):
                return said
            else:
                smach.logerr(
                    "Outcome callback returned a non-string '%s', using default outcome '%s'" % (said, self._default_outcome)
                )
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            raise smach.InvalidUserCodeError(
                "Could not execute outcome callback '%s': %s" % (self._outcome_cb, trace())
            ) from error
        return otherwise

    def request_preempt(self) -> None:
        """Asks all states to end."""
        smach.State.request_preempt(self)
        with self._done_cond:
            self._done_cond.notify_all()

    # ── in the thread of a state ──

    def _state_runner(self, label: Any) -> None:
        self._ready_event.wait()
        self.call_transition_cbs()
        outcome = self._child_outcomes[label] = self._run(label)
        if outcome is None:
            # The container does not hear of it, and waits on: as in the original.
            raise smach.InvalidStateError("Concurrent state '%s' returned no outcome on termination." % label)
        smach.loginfo("Concurrent state '%s' returned outcome '%s' on termination." % (label, outcome))
        with self._done_cond:
            self.call_transition_cbs()
            preempt_others = False
            if self._child_termination_cb:
                try:
                    preempt_others = self._child_termination_cb(self._child_outcomes)
                except BaseException as error:
                    if smach.is_the_end(error):
                        raise
                    raise smach.InvalidUserCodeError("Could not execute child termination callback: " + trace()) from error
            if preempt_others or all(outcome is not None for outcome in self._child_outcomes.values()):
                self._done_cond.notify_all()

    def _run(self, label: Any) -> Any:
        state = self._states[label]
        try:
            _told.is_child(self, label, state)
            view = smach.Remapper(
                self.userdata,
                state.get_registered_input_keys(),
                state.get_registered_output_keys(),
                self._remappings[label],
            )
            return state.execute(view)
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            self._user_code_exception = True
            with self._done_cond:
                self._done_cond.notify_all()
            raise smach.InvalidStateError("Could not execute child state '%s': %s" % (label, trace())) from error

    # ── as a container ──

    def get_children(self) -> dict[str, Any]:
        """The states, by their labels."""
        return self._states

    def __getitem__(self, key: Any) -> Any:
        return self._states[key]

    def get_initial_states(self) -> list[str]:
        """All states."""
        return list(self._states)

    def set_initial_state(self, initial_states: Iterable[str], userdata: Any) -> None:
        """Only the userdata can be set: all states are initial."""
        if 0 < len(list(initial_states)) < len(self._states):
            smach.logwarn(
                "Attempting to set initial states in Concurrence container, but Concurrence children are always all"
                " executed initially, ignoring call."
            )
        self.userdata.update(userdata)

    def get_active_states(self) -> list[str]:
        """Those that have not ended."""
        return [label for label, outcome in self._child_outcomes.items() if outcome is None]

    def get_internal_edges(self) -> list[Any]:
        """(outcome, state, outcome of the container) as mapped."""
        return [(needed[label], label, mapped) for mapped, needed in self._outcome_map.items() for label in needed]

    def check_consistency(self) -> None:
        """Raises if the map names an outcome that a state does not have."""
        for needed in self._outcome_map.values():
            for label, outcome in needed.items():
                registered = self._states[label].get_registered_outcomes()
                if outcome not in registered:
                    raise smach.InvalidTransitionError(
                        "Outcome map in SMACH Concurrence references a state outcome that does not exist. Requested"
                        " state outcome: '%s', but state '%s' only has outcomes %s" % (outcome, label, registered)
                    )
