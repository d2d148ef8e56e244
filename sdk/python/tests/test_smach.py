"""`smach`: what it does, says and tells, without ROS."""

import contextlib
import io
import os
import sys
import threading
import types
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [ROOT, os.path.join(ROOT, "ros1")]

import smach  # noqa: E402
from hrdsl.errors import Stopped  # noqa: E402
from smach import _told  # noqa: E402


class Says(smach.State):
    """Returns the outcomes that it is given, one at each execution."""

    def __init__(self, *outcomes, **keys):
        smach.State.__init__(self, outcomes=sorted(set(outcomes)), **keys)
        self.left = list(outcomes)

    def execute(self, ud):
        return self.left.pop(0)


class Does(smach.State):
    """Calls a function."""

    def __init__(self, function, outcomes=("done",), **keys):
        smach.State.__init__(self, outcomes=outcomes, **keys)
        self.function = function

    def execute(self, ud):
        return self.function(self, ud)


class Quiet(unittest.TestCase):
    """Keeps what is logged."""

    def setUp(self):
        self.logged = []
        before = smach.loginfo, smach.logwarn, smach.logdebug, smach.logerr
        self.addCleanup(smach.set_loggers, *before)
        keep = [lambda text, kind=kind: self.logged.append((kind, text)) for kind in ("info", "warn", "debug", "error")]
        smach.set_loggers(*keep)
        self.addCleanup(smach.Container._construction_stack.clear)

    def said(self, kind):
        return [text for its, text in self.logged if its == kind]


class Machines(Quiet):
    def test_transitions_lead_to_states_and_outcomes(self):
        machine = smach.StateMachine(outcomes=["end", "failed"])
        with machine:
            smach.StateMachine.add("A", Says("again", "go"), transitions={"again": "A", "go": "B"})
            machine.add("B", Says("failed"))  # falls through
        self.assertEqual(machine.execute(), "failed")
        self.assertEqual(
            self.said("info"),
            [
                "State machine starting in initial state 'A' with userdata: \n\t[]",
                "State machine transitioning 'A':'again'-->'A'",
                "State machine transitioning 'A':'go'-->'B'",
                "State machine terminating 'B':'failed':'failed'",
            ],
        )
        self.assertEqual(machine.get_active_states(), ["None"])
        self.assertIn(("failed", "B", None), machine.get_internal_edges())

    def test_an_outcome_that_was_not_declared_is_told(self):
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            machine.add("A", Does(lambda state, ud: "dnoe"), {"done": "end"})
        with self.assertRaisesRegex(smach.InvalidTransitionError, "Attempted to return outcome 'dnoe' from state 'A'"):
            machine.execute()
        self.assertFalse(machine.is_running())
        self.assertTrue(self.said("error")[-1].startswith("InvalidTransitionError: Attempted"))

    def test_construction_is_checked(self):
        with self.assertRaisesRegex(smach.InvalidStateError, "no container is opened"):
            smach.StateMachine.add("A", Says("go"))
        machine = smach.StateMachine(outcomes=["end"])
        machine.open()
        self.assertTrue(machine.is_opened())
        machine.add("A", Says("go"), {"go": "end"})
        with self.assertRaisesRegex(smach.InvalidStateError, "label is already being used"):
            machine.add("A", Says("go"), {"go": "end"})
        with self.assertRaisesRegex(smach.InvalidTransitionError, "Specified outcome 'og' on state 'B'"):
            machine.add("B", Says("go"), {"og": "end"})
        with self.assertRaisesRegex(smach.InvalidStateError, "without having opened a"):
            smach.Concurrence.add("C", Says("go"))
        machine.close()
        self.assertFalse(machine.is_opened())
        with self.assertRaises(smach.InvalidConstructionError):
            machine.assert_opened("not open")

    def test_a_machine_that_leads_nowhere_says_so_twice_and_returns_none(self):
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            machine.add("A", Says("go", "no"), {"go": "B"})
        self.assertIsNone(machine.execute())
        errors = self.said("error")
        self.assertEqual(errors.count("Container consistency check failed."), 2)
        self.assertIn("State 'A' references unknown states: ['B']", errors[0])
        self.assertIn("State 'A' references unregistered outcomes: ['no']", errors[0])
        with self.assertRaises(smach.InvalidTransitionError):
            machine.check_consistency()
        with self.assertRaisesRegex(smach.InvalidTransitionError, "No initial state set"):
            smach.StateMachine(outcomes=["end"]).check_consistency()

    def test_auto_connects_to_what_is_added_next(self):
        machine = smach.StateMachine(outcomes=["end"])
        with machine.opened():
            smach.StateMachine.add_auto("A", Says("go"), connector_outcomes=["go"])
            smach.StateMachine.add_auto("B", Says("go"), ["go"])
            smach.StateMachine.add("C", Says("go"), {"go": "end"})
            with self.assertRaises(smach.InvalidStateError):
                smach.StateMachine.add_auto("D", Says("end"), ["og"])
        self.assertEqual(machine.execute(), "end")

    def test_what_user_code_raises_has_its_traceback(self):
        machine = smach.StateMachine(outcomes=["done"])
        with machine:
            machine.add("A", Does(lambda state, ud: 1 / 0))
        with self.assertRaisesRegex(smach.InvalidUserCodeError, "(?s)Could not execute state 'A'.*ZeroDivisionError"):
            machine.execute()

    def test_the_end_of_a_test_is_no_failure_of_a_state(self):
        def stop(state, ud):
            raise Stopped()

        inner = smach.StateMachine(outcomes=["done"])
        with inner:
            inner.add("A", Does(stop))
        outer = smach.StateMachine(outcomes=["done"])
        with outer:
            outer.add("INNER", inner)
        with self.assertRaises(Stopped):
            outer.execute()
        self.assertEqual(self.said("error"), [])

    def test_callbacks_see_states_in_order(self):
        seen = []
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            machine.add("A", Says("go"), {"go": "B"})
            machine.add("B", Says("end"))
        machine.register_start_cb(lambda ud, states, *args: seen.append(("start", states, args)), [1])
        machine.register_transition_cb(lambda ud, states: seen.append(("transition", states)))
        machine.register_termination_cb(lambda ud, states, outcome: seen.append(("end", states, outcome)))
        machine.register_termination_cb(lambda: None)
        machine.execute()
        self.assertEqual(seen, [("start", ["A"], (1,)), ("transition", ["B"]), ("end", ["B"], "end")])
        self.assertIn("Could not execute termination callback: Traceback", self.said("error")[0])

    def test_it_begins_where_it_is_set_to(self):
        data = smach.UserData()
        data.x = 5
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            machine.add("A", Says("end"))
            machine.add("B", Does(lambda state, ud: "end" if ud.x == 5 else "no", ["end"], input_keys=["x"]))
        machine.set_initial_state(["B", "A"], data)
        self.assertEqual(len(self.said("warn")), 1)
        self.assertEqual((machine.get_initial_states(), machine.execute()), (["B"], "end"))
        self.assertIs(machine["A"], machine.get_children()["A"])
        with self.assertRaises(KeyError):
            machine["C"]

    def test_shutdown_ends_it_without_an_outcome(self):
        is_over = []
        smach.set_shutdown_check(lambda: bool(is_over))
        self.addCleanup(smach.set_shutdown_check, smach.util.is_shutdown)
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            machine.add("A", Does(lambda state, ud: is_over.append(1) or "done"), {"done": "A"})
        self.assertIsNone(machine.execute())


class Data(Quiet):
    def test_keys_are_remapped(self):
        machine = smach.StateMachine(outcomes=["end"], input_keys=["given"], output_keys=["sum"])
        machine.userdata.local = 2

        def add(state, ud):
            ud.total = ud.a + ud["b"]
            self.assertEqual(("a" in ud, "given" in ud, "total" in ud), (True, False, False))
            return "end"

        state = Does(add, ["end"], input_keys=["a", "b"], output_keys=["total"])
        with machine:
            machine.add("A", state, remapping={"a": "given", "b": "local", "total": "sum"})
        data = smach.UserData()
        data["given"] = 40
        self.assertEqual(machine.execute(data), "end")
        self.assertEqual(data.sum, 42)
        self.assertEqual(sorted(data.keys()), ["given", "sum"])

    def test_undeclared_keys(self):
        machine = smach.StateMachine(outcomes=["done"])
        machine.userdata.x = 1
        with machine:
            machine.add("A", Does(lambda state, ud: setattr(ud, "x", 2) or "done"), {"done": "B"})
            machine.add("B", Does(lambda state, ud: ud.x))
        with self.assertRaisesRegex(smach.InvalidUserCodeError, "declared as input"):
            machine.execute()
        self.assertEqual(machine.userdata.x, 1)
        self.assertTrue(any("Writing to SMACH userdata key 'x'" in text for text in self.said("error")))

    def test_missing_keys(self):
        with self.assertRaises(KeyError):
            smach.UserData().x
        self.assertEqual(self.said("error"), ["Userdata key 'x' not available. Available keys are: []"])
        machine = smach.StateMachine(outcomes=["done"], input_keys=["x"], output_keys=["y"])
        with machine:
            machine.add("A", Does(lambda state, ud: "done"))
        machine.execute(smach.UserData())
        self.assertEqual(len(self.said("warn")), 2)

    def test_what_is_only_read_does_not_change(self):
        kept = types.SimpleNamespace(value=1, inner=types.SimpleNamespace(x=2), items=[3])
        ud = smach.UserData()
        ud.kept = kept
        view = smach.Remapper(ud, ["kept"]).kept
        view.value = 7
        self.assertEqual((kept.value, view.value, view.inner.x, view.items), (1, 7, 2, [3]))
        with self.assertRaises(TypeError):
            del view.inner
        self.assertIs(smach.Remapper(ud, ["kept"], ["kept"]).kept, kept)

    def test_extract_and_merge(self):
        ud = smach.UserData()
        ud.a, ud.b = [1], 2
        other = ud.extract(["a", "b"], {"x": "a"})
        self.assertEqual((sorted(other.keys()), other.x is ud.a, other.x), (["b", "x"], False, [1]))
        ud.merge(other, ["x"], {"x": "c"})
        self.assertEqual(ud.c, [1])

    def test_callbacks_declare_their_keys(self):
        @smach.cb_interface(outcomes=["ok"], input_keys=["n"], output_keys=["m"])
        def double(ud, factor, plus=0):
            ud.m = ud.n * factor + plus
            return "ok"

        machine = smach.StateMachine(outcomes=["ok"])
        machine.userdata.n = 4
        with machine:
            machine.add("A", smach.CBState(double, cb_args=[2], cb_kwargs={"plus": 1}))
        self.assertEqual((machine.execute(), machine.userdata.m), ("ok", 9))


class Preemption(Quiet):
    def test_a_state_that_services_it_ends_the_machine(self):
        def work(state, ud):
            machine.request_preempt()
            if state.preempt_requested():
                state.service_preempt()
                return "preempted"
            return "done"

        machine = smach.StateMachine(outcomes=["done", "preempted"])
        with machine:
            machine.add("A", Does(work, ["done", "preempted"]))
        self.assertEqual(machine.execute(), "preempted")
        self.assertFalse(machine.preempt_requested())

    def test_one_that_does_not_leaves_it_to_the_next(self):
        def ask(state, ud):
            machine.request_preempt()
            return "done"

        def heed(state, ud):
            was = state.preempt_requested()
            state.service_preempt()
            return "preempted" if was else "done"

        machine = smach.StateMachine(outcomes=["done", "preempted"])
        with machine:
            machine.add("A", Does(ask), {"done": "B"})
            machine.add("B", Does(heed, ["done", "preempted"]))
        self.assertEqual(machine.execute(), "preempted")
        self.assertIn("Last state 'A' did not service preempt. Preempting next state 'B' before executing...", self.said("info"))


class Others(Quiet):
    def test_a_sequence(self):
        sequence = smach.Sequence(outcomes=["ok", "bad"], connector_outcome="ok")
        with sequence:
            smach.Sequence.add("A", Says("ok"))
            smach.Sequence.add("B", Says("ok"), {"ok": "bad"})
            smach.Sequence.add("C", Says("ok"))
        self.assertEqual(sequence.execute(), "bad")
        self.assertIn(("ok", "A", "B"), sequence.get_internal_edges())

    def test_an_iterator(self):
        seen = []

        def visit(state, ud):
            seen.append(ud.item)
            return "found" if ud.item == 3 else "next"

        def build(items):
            iterator = smach.Iterator(["found", "none"], [], [], it=items, it_label="item", exhausted_outcome="none")
            with iterator:
                state = Does(visit, ["found", "next"], input_keys=["item"])
                smach.Iterator.set_contained_state("LOOK", state, loop_outcomes=["next"])
            return iterator

        self.assertEqual((build(range(1, 9)).execute(), seen), ("found", [1, 2, 3]))
        self.assertEqual(build(lambda: [1, 2]).execute(), "none")

    def build(self, slow, fast=lambda state, ud: "fast", **how):
        both = smach.Concurrence(outcomes=["ok", "bad", "preempted"], default_outcome="bad", **how)
        with both:
            smach.Concurrence.add("SLOW", Does(slow, ["slow", "preempted"]))
            smach.Concurrence.add("FAST", Does(fast, ["fast"]))
        return both

    def test_a_concurrence_maps_outcomes(self):
        both = self.build(lambda state, ud: "slow", outcome_map={"ok": {"SLOW": "slow", "FAST": "fast"}, "bad": {}})
        self.assertEqual(both.execute(), "ok")
        called = []
        both = self.build(lambda state, ud: "slow", outcome_cb=lambda outcomes: called.append(outcomes) or "ok")
        self.assertEqual((both.execute(), called), ("ok", [{"SLOW": "slow", "FAST": "fast"}]))
        self.assertEqual(self.build(lambda state, ud: "slow").execute(), "bad")

    def test_a_child_that_ends_may_end_the_others(self):
        asked = threading.Event()

        def wait(state, ud):
            while not state.preempt_requested():
                asked.wait(0.01)
            state.service_preempt()
            return "preempted"

        both = self.build(wait, child_termination_cb=lambda outcomes: outcomes["FAST"] == "fast")
        self.assertEqual(both.execute(), "bad")
        self.assertIn("Concurrent Outcomes: {'SLOW': 'preempted', 'FAST': 'fast'}", self.said("info"))

    def test_a_child_that_fails(self):
        self.addCleanup(setattr, threading, "excepthook", threading.excepthook)
        threading.excepthook = lambda given: None
        with self.assertRaisesRegex(smach.InvalidStateError, "raised an exception"):
            self.build(lambda state, ud: 1 / 0).execute()

    def test_policies_are_checked(self):
        with self.assertRaisesRegex(smach.InvalidStateError, "Default outcome 'no' is unregistered"):
            smach.Concurrence(outcomes=["ok"], default_outcome="no")
        with self.assertRaisesRegex(smach.InvalidStateError, "No states"):
            smach.Concurrence(outcomes=["ok"], default_outcome="ok").execute()


class Kept:
    """Stands for the exchange with hrdsl."""

    def __init__(self):
        self.told = []

    def polled(self, kind):
        pass

    def declare(self, machine, states, transitions, outcomes):
        self.told.append({"machine": machine, "states": states, "transitions": transitions, "outcomes": outcomes})

    def begin(self, *what):
        self.told.append(what)

    def transition(self, *what):
        self.told.append(what)


class Telling(Quiet):
    def setUp(self):
        super().setUp()
        self.exchange = Kept()
        self.addCleanup(setattr, _told, "_exchange", _told._exchange)
        _told._exchange = lambda: self.exchange
        _told._outermost.clear()
        _told._told.clear()

    def test_machines_and_their_moves(self):
        inner = smach.StateMachine(outcomes=["got"])
        with inner:
            inner.add("REACH", Says("got"))
        outer = smach.StateMachine(outcomes=["end"])
        with outer:
            outer.add("IDLE", Says("go", "end"), {"go": "GRASP"})
            outer.add("GRASP", inner, {"got": "IDLE"})
        outer.execute()
        self.assertEqual(
            self.exchange.told,
            [
                {
                    "machine": "machine",
                    "states": ["IDLE", "GRASP"],
                    "transitions": [["IDLE", "go", "GRASP"], ["IDLE", "end", "end"], ["GRASP", "got", "IDLE"]],
                    "outcomes": ["end"],
                },
                {
                    "machine": "machine/GRASP",
                    "states": ["REACH"],
                    "transitions": [["REACH", "got", "got"]],
                    "outcomes": ["got"],
                },
                ("machine", "IDLE"),
                ("machine", "IDLE", "Says", "go", "GRASP"),
                ("machine/GRASP", "REACH"),
                ("machine/GRASP", "REACH", "Says", "got", "got"),
                ("machine", "GRASP", "StateMachine", "got", "IDLE"),
                ("machine", "IDLE", "Says", "end", "end"),
            ],
        )
        outer["IDLE"].left = ["end"]
        outer.execute()
        self.assertEqual(self.exchange.told[8:], [("machine", "IDLE"), ("machine", "IDLE", "Says", "end", "end")])

    def test_what_is_never_entered_is_declared_through_every_container(self):
        def machine(label):
            made = smach.StateMachine(outcomes=["end"])
            with made:
                made.add(label, Says("end"))
            return made

        both = smach.Concurrence(outcomes=["end"], default_outcome="end")
        with both:
            both.add("LEFT", machine("L"))
            both.add("RIGHT", Says("end"))
        each = smach.Iterator(["end"], [], [], [1, 2], "item", "end")
        with each:
            each.set_contained_state("ITEM", machine("I"), loop_outcomes=["end"])
        outer = smach.StateMachine(outcomes=["end"])
        with outer:
            outer.add("START", Says("end"), {"end": "end"})
            outer.add("BOTH", both)
            outer.add("EACH", each)
        outer.execute()
        declared = [(told["machine"], told["states"]) for told in self.exchange.told if isinstance(told, dict)]
        self.assertEqual(
            declared,
            [
                ("machine", ["START", "BOTH", "EACH"]),
                ("machine/BOTH", ["LEFT", "RIGHT"]),
                ("machine/BOTH/LEFT", ["L"]),
                ("machine/EACH", ["ITEM"]),
                ("machine/EACH/ITEM", ["I"]),
            ],
        )
        both.execute()
        self.assertEqual(sorted(self.exchange.told[-4:])[:2], [("machine/BOTH", "LEFT"), ("machine/BOTH", "RIGHT")])

    def test_further_machines_are_counted(self):
        for label, name in (("A", "machine"), ("B", "machine#2"), ("A", "machine")):
            machine = smach.StateMachine(outcomes=["end"])
            with machine:
                machine.add(label, Says("end"))
            machine.execute()
            self.assertEqual(self.exchange.told[-1][0], name)
        # Each begins and ends; the last is the first again, and is not declared twice.
        self.assertEqual(len(self.exchange.told), 8)


class Alone(unittest.TestCase):
    def test_without_hrdsl_it_prints(self):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            machine = smach.StateMachine(outcomes=["end"])
            with machine:
                machine.add("A", Says("end"))
            machine.execute()
        lines = out.getvalue().split("\n")[4:]
        begin = "[  INFO ] : State machine starting in initial state 'A' with userdata: "
        self.assertEqual(lines, [begin, "\t[]", "[  INFO ] : State machine terminating 'A':'end':'end'", ""])


if __name__ == "__main__":
    unittest.main()
