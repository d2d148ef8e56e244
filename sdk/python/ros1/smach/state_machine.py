"""`StateMachine`: one state at a time, and transitions by outcomes."""

from __future__ import annotations

import threading

import smach
from smach import _told
from smach.container import Container, trace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterable, Mapping

__all__ = ["StateMachine"]


class StateMachine(Container):
    """Runs its states one after the other, each with the userdata that it declares."""

    def __init__(self, outcomes: Iterable[str], input_keys: list[str] = [], output_keys: list[str] = []) -> None:
        Container.__init__(self, outcomes, input_keys, output_keys)
        self._state_transitioning_lock = threading.Lock()
        self._is_running = False
        self._initial_state_label: Any = None
        self._set_nothing()
        self._preempted_label: Any = None
        self._preempted_state: Any = None
        self._states: dict[Any, Any] = {}
        self._transitions: dict[Any, dict[Any, Any]] = {}
        self._remappings: dict[Any, Any] = {}
        self._constants: dict[Any, Any] = {}
        # For `add_auto`: what was added last, and which of its outcomes lead to what comes next.
        self._last_added_label: Any = None
        self._connector_outcomes: list[str] = []

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key != "_state_transitioning_lock"}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        self.__dict__ = kept
        self._state_transitioning_lock = threading.Lock()

    # ── construction ──

    @staticmethod
    def add(label: Any, state: Any, transitions: Any = None, remapping: Any = None, constants: Any = None) -> Any:
        """Adds a state to the open machine; outcomes without a transition are outcomes of the machine.

        `remapping` has the machine's keys by the state's, `constants` the values of keys set before the state runs.
        """
        self = StateMachine._currently_opened_container()
        smach.logdebug("Adding state (%s, %s, %s)" % (label, state, transitions))
        if self._initial_state_label is None:
            self._initial_state_label = label
        transitions = {} if transitions is None else transitions
        self.check_state_spec(label, state, transitions)
        if label in self._states:
            raise smach.InvalidStateError(
                'Attempting to add state with label "%s" to state machine, but this label is already being used.' % label
            )
        smach.logdebug("Adding state '%s' to the state machine." % label)
        missing = {outcome: None for outcome in state.get_registered_outcomes() if outcome not in transitions}
        transitions.update(missing)  # in the program's own dictionary, as ever
        smach.logdebug("State '%s' is missing transitions: %s" % (label, missing))
        self._states[label] = state
        self._transitions[label] = transitions
        self._remappings[label] = {} if remapping is None else remapping
        self._constants[label] = {} if constants is None else constants
        smach.logdebug("TRANSITIONS FOR %s: %s" % (label, transitions))
        if self._connector_outcomes and self._last_added_label is not None:
            for outcome in self._connector_outcomes:
                self._transitions[self._last_added_label][outcome] = label
            self._connector_outcomes, self._last_added_label = [], None
        return state

    @staticmethod
    def add_auto(
        label: Any,
        state: Any,
        connector_outcomes: Any,
        transitions: Any = None,
        remapping: Any = None,
        constants: Any = None,
    ) -> Any:
        """Adds a state; these outcomes of it lead to the state that is added next."""
        self = StateMachine._currently_opened_container()
        added = smach.StateMachine.add(label, state, transitions, remapping, constants)
        registered = state.get_registered_outcomes()
        if not all(outcome in registered for outcome in connector_outcomes):
            raise smach.InvalidStateError(
                "Attempting to auto-connect states with outcomes %s, but state '%s' only has registerd outcomes: %s"
                % (connector_outcomes, label, registered)
            )
        self._last_added_label, self._connector_outcomes = label, connector_outcomes
        return added

    # ── running ──

    def _set_nothing(self) -> None:
        self._current_label: Any = None
        self._current_state: Any = None
        self._current_transitions: Any = None
        self._current_outcome: Any = None

    def _set_current_state(self, label: Any) -> None:
        self._set_nothing()
        if label is not None:
            self._current_label = label
            self._current_state = self._states[label]
            self._current_transitions = self._transitions[label]

    def execute(self, parent_ud: Any = None) -> Any:
        """Runs from the initial state until a transition leads to an outcome, and returns that. None if the machine is
        not sound, or is to stop."""
        with self._state_transitioning_lock:
            try:
                self.check_consistency()
            except (smach.InvalidStateError, smach.InvalidTransitionError):
                smach.logerr("Container consistency check failed.")
                return None
            self._is_running = True
            self._preempted_label = self._preempted_state = None
            self._set_current_state(self._initial_state_label)
            self._copy_input_keys(parent_ud, self.userdata)
            smach.loginfo(
                "State machine starting in initial state '%s' with userdata: \n\t%s" % (self._current_label, self.userdata.keys())
            )
            _told.begins(self)
            self.call_start_cbs()
            outcome = None
            try:
                while outcome is None and self._is_running and not smach.is_shutdown():
                    outcome = self._update_once()
                self._copy_output_keys(self.userdata, parent_ud)
            finally:
                self._is_running = False
        return outcome

    def _update_once(self) -> Any:
        """Runs the current state, and goes on to the next: the outcome of the machine, if it has ended."""
        label, state = self._current_label, self._current_state
        if label not in self._states:
            raise smach.InvalidStateError("State '%s' does not exist. Available states are: %s" % (label, list(self._states)))
        if self.preempt_requested():
            self._hand_preemption_on()
        outcome = self._run(label, state)
        registered = state.get_registered_outcomes()
        if outcome not in registered:
            raise smach.InvalidTransitionError(
                "Attempted to return outcome '%s' from state '%s' of type '%s' which only has registered outcomes: %s"
                % (outcome, label, state, registered)
            )
        if outcome not in self._current_transitions:
            raise smach.InvalidTransitionError(
                "Outcome '%s' of state '%s' is not bound to any transition target. Bound transitions include: %s"
                % (outcome, label, self._current_transitions)
            )
        target = self._current_transitions[outcome]
        if target not in self._states:
            return self._terminate(label, state, outcome, target)
        self._set_current_state(target)
        smach.loginfo("State machine transitioning '%s':'%s'-->'%s'" % (label, outcome, target))
        _told.moves(self, label, state, outcome, target)
        self.call_transition_cbs()
        return None

    def _run(self, label: Any, state: Any) -> Any:
        self._state_transitioning_lock.release()
        try:
            for key, value in self._constants[label].items():
                self.userdata[key] = value
            _told.is_child(self, label, state)
            view = smach.Remapper(
                self.userdata,
                state.get_registered_input_keys(),
                state.get_registered_output_keys(),
                self._remappings[label],
            )
            return state.execute(view)
        except smach.InvalidUserCodeError:
            smach.logerr("State '%s' failed to execute." % label)
            raise
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            raise smach.InvalidUserCodeError("Could not execute state '%s' of type '%s': %s" % (label, state, trace())) from error
        finally:
            self._state_transitioning_lock.acquire()

    def _terminate(self, label: Any, state: Any, outcome: Any, target: Any) -> Any:
        if self._preempt_requested and self._preempted_state is not None and not state.preempt_requested():
            self.service_preempt()
        outcomes = self.get_registered_outcomes()
        if target not in outcomes:
            target = outcome  # the state's outcome is one of the machine, too
        if target not in outcomes:
            raise smach.InvalidTransitionError(
                "Outcome '%s' of state '%s' with transition target '%s' is neither a registered state nor a registered"
                " container outcome." % (outcome, label, target)
            )
        self._set_current_state(None)
        smach.loginfo("State machine terminating '%s':'%s':'%s'" % (label, outcome, target))
        _told.moves(self, label, state, outcome, target)
        self.call_termination_cbs([label], target)
        return target

    # ── preemption ──

    def request_preempt(self) -> None:
        """Asks the machine, and the state that runs in it, to end."""
        with self._state_transitioning_lock:
            self._preempt_requested = True
            if self._current_state is not None:
                self._preempt_current_state()

    def _hand_preemption_on(self) -> None:
        """The machine was asked to end, and is about to run another state."""
        smach.loginfo("Preempt requested on state machine before executing the next state.")
        if self._preempted_state is None:  # nothing ran when it was asked
            self._preempt_current_state()
        elif self._preempted_state.preempt_requested():
            smach.loginfo(
                "Last state '%s' did not service preempt. Preempting next state '%s' before executing..."
                % (self._preempted_label, self._current_label)
            )
            self._preempt_current_state()
        else:  # the state has done what was asked for
            self._preempt_requested = False
            self._preempted_state = None

    def _preempt_current_state(self) -> None:
        if self._preempted_state is self._current_state:
            return
        if self._preempted_state is not None:
            self._preempted_state.recall_preempt()
        self._preempted_state = self._current_state
        self._preempted_label = self._current_label
        try:
            self._preempted_state.request_preempt()
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            smach.logerr("Failed to preempt contained state '%s': %s" % (self._preempted_label, trace()))

    # ── as a container ──

    def get_children(self) -> dict[str, Any]:
        """The states, by their labels."""
        return self._states

    def __getitem__(self, key: Any) -> Any:
        if key not in self._states:
            smach.logerr(
                "Attempting to get state '%s' from StateMachine container. The only available states are: %s"
                % (key, list(self._states))
            )
            raise KeyError()
        return self._states[key]

    def set_initial_state(self, initial_states: Any, userdata: Any = None) -> None:
        """Begins in the first of these states, with these values beside those that the userdata has."""
        smach.logdebug("Setting initial states to %s" % (initial_states,))
        if len(initial_states) > 1:
            smach.logwarn(
                "Attempting to set initial state to include more than one state, but the StateMachine container can"
                " only have one initial state. Taking the first one."
            )
        if len(initial_states) > 0:
            self._initial_state_label = initial_states[0]
        if userdata is not None:
            self.userdata.update(userdata)

    def get_active_states(self) -> list[str]:
        """The state that runs; `None`, as a text, if none does."""
        return [str(self._current_label)]

    def get_initial_states(self) -> list[str]:
        """The state to begin with."""
        return [str(self._initial_state_label)]

    def get_internal_edges(self) -> list[Any]:
        """(outcome, from, to) for each transition; `to` is None for those that were not given."""
        return [
            (outcome, label, target)
            for label, transitions in self._transitions.items()
            for outcome, target in transitions.items()
        ]

    def is_running(self) -> bool:
        """Whether the machine is being executed."""
        _told.polled()
        return self._is_running

    # ── soundness ──

    def check_state_spec(self, label: Any, state: Any, transitions: Mapping[str, Any]) -> None:
        """Raises if a transition is from an outcome that the state does not have."""
        registered = state.get_registered_outcomes()
        for outcome in transitions:
            if outcome not in registered:
                raise smach.InvalidTransitionError(
                    "Specified outcome '%s' on state '%s', which only has available registered outcomes: %s"
                    % (outcome, label, registered)
                )

    def check_consistency(self) -> None:
        """Raises if the machine does not know where to begin, or where some transition leads."""
        outcomes = self.get_registered_outcomes()
        available = list(dict.fromkeys([*self._states, *outcomes]))
        errors = ""
        if self._initial_state_label is None:
            errors += "\n\tNo initial state set."
        elif self._initial_state_label not in self._states:
            errors += "\n\tInitial state label: '%s' is not in the state machine." % self._initial_state_label
        for label, transitions in self._transitions.items():
            given = {target: None for target in transitions.values() if target is not None and target != ""}
            unknown = [target for target in given if target not in available]
            if unknown:
                errors += "\n\tState '%s' references unknown states: %s" % (label, unknown)
            left = [outcome for outcome, target in transitions.items() if target is None or target == ""]
            unregistered = [outcome for outcome in left if outcome not in outcomes]
            if unregistered:
                errors += "\n\tState '%s' references unregistered outcomes: %s" % (label, unregistered)
        if errors:
            raise smach.InvalidTransitionError(
                "State machine failed consistency check: %s\n\n\tAvailable states: %s" % (errors, available)
            )
