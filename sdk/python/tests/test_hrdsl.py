"""`python3 -m unittest discover sdk/python/tests`: the SDK against a harness in a thread, and the example's machine."""

import copy
import json
import os
import pickle
import re
import sys
import threading
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [ROOT, os.path.join(ROOT, "..", "..", "examples", "handover")]

import hrdsl  # noqa: E402
from hrdsl import cover, link  # noqa: E402
from system import System  # noqa: E402


class Harness(threading.Thread):
    """Answers each request by a function, or as a system does."""

    def __init__(self, answer):
        super().__init__(daemon=True)
        read, its_write = os.pipe()
        its_read, self.write = os.pipe()
        self.lines, self.answer, self.requests = os.fdopen(read), answer, []
        self.link = link.Link()
        self.link.connect(its_write, its_read)
        self.its_write = its_write
        self.start()

    def run(self):
        for line in self.lines:
            self.requests.append(json.loads(line))
            reply = self.answer(self.requests[-1]) if callable(self.answer) else self.answer.answer(line)
            if reply is not None:
                os.write(self.write, (json.dumps(reply) + "\n").encode())

    def close(self):
        os.close(self.its_write)
        self.join()
        self.lines.close()
        os.close(self.link._in)
        os.close(self.write)


class Messages(unittest.TestCase):
    def node(self, answer):
        harness = Harness(answer)
        self.addCleanup(harness.close)
        link._link = harness.link
        self.addCleanup(setattr, link, "_link", None)
        if "hrdsl.runner" not in sys.modules:
            sys.modules["hrdsl.runner"] = None  # no farewell at exit
            self.addCleanup(sys.modules.pop, "hrdsl.runner")
        return harness, hrdsl.Node("test")

    def test_a_state_machine_tells_what_it_is_and_does(self):
        harness, node = self.node(System())
        states = {"WAIT": {"asked": "GIVE"}, "GIVE": {"given": "WAIT", "lost": "stuck"}}
        machine = hrdsl.StateMachine("arm", states, ["stuck"])
        machine.begin("WAIT")
        self.assertEqual((machine.take("asked"), machine.state), ("GIVE", "GIVE"))
        for wrong, why in (
            (lambda: machine.take("asked"), "arm has no outcome asked in GIVE; it has given, lost"),
            (lambda: machine.begin("GONE"), "arm has no state GONE; it has WAIT, GIVE"),
            (lambda: hrdsl.StateMachine("leg", {"A": {"ok": "B"}}), "leg: ok leads from A to B, which is no state and no outcome"),
        ):
            with self.assertRaisesRegex(ValueError, why):
                wrong()
        self.assertEqual((machine.take("lost"), machine.state), ("stuck", None))
        with self.assertRaisesRegex(ValueError, "arm is in no state: begin it"):
            machine.take("lost")
        node.sleep(1)
        told = [request for request in harness.requests if request["request"] in ("machine", "transition")]
        edges = [["WAIT", "asked", "GIVE"], ["GIVE", "given", "WAIT"], ["GIVE", "lost", "stuck"]]
        declared = {"request": "machine", "name": "arm", "states": ["WAIT", "GIVE"], "transitions": edges, "outcomes": ["stuck"]}
        step = {"request": "transition", "machine": "arm"}
        self.assertEqual(
            told,
            [
                declared,
                {**step, "next": "WAIT"},
                {**step, "label": "WAIT", "state": "", "outcome": "asked", "next": "GIVE"},
                {**step, "label": "GIVE", "state": "", "outcome": "lost", "next": "stuck"},
            ],
        )

    def test_a_motion_is_begun_and_waited_for(self):
        harness, node = self.node(System(commands=lambda request: (1500000000, None)))
        self.assertIs(node.arm("robot.arm").move_to((1, 2, 3)), True)
        act = {"request": "act", "on": "robot.arm", "do": "move_to", "args": {"to": [1.0, 2.0, 3.0]}, "wait": False, "call": 1}
        self.assertEqual(harness.requests[-2:], [act, {"request": "wait"}])
        self.assertEqual(node.now(), 1.5)
        self.assertIs(node.gripper("robot.grip").command("drop", command="gently", force=None), True)
        act = {"request": "act", "on": "robot.grip", "do": "drop", "args": {"command": "gently"}, "wait": False, "call": 2}
        self.assertEqual(harness.requests[-2], act)

    def test_devices_get_the_commands_of_their_kinds(self):
        harness, node = self.node(System(commands=lambda request: (0, None)))
        arm, base = node.arm("robot.arm"), node.base("robot.wheels")
        for call, name, command, args in (
            (lambda: arm.move_joints((1, 2), speed=0.5), "robot.arm", "move_joints", {"to": [1.0, 2.0], "speed": 0.5}),
            (lambda: arm.follow([(0, 1), (2, 3)], (0.5, 1)), "robot.arm", "follow", {"positions": [0.0, 1.0, 2.0, 3.0], "times": [0.5, 1.0]}),
            (lambda: arm.follow([], []), "robot.arm", "follow", {"positions": [], "times": []}),
            (lambda: arm.aim(1, 0.25), "robot.arm", "aim", {"joint": 1, "to": 0.25}),
            (arm.stop, "robot.arm", "stop", {}),
            (lambda: base.drive(0.3), "robot.wheels", "drive", {"forward": 0.3, "turn": 0.0}),
            (lambda: base.drive(1, turn=-1, sideways=0.5), "robot.wheels", "drive", {"forward": 1.0, "turn": -1.0, "sideways": 0.5}),
            (base.stop, "robot.wheels", "stop", {}),
            (node.gripper("robot.grip").open, "robot.grip", "open", {}),
            (node.gripper("robot.grip").close, "robot.grip", "close", {}),
        ):
            self.assertIs(call(), True)
            (act,) = [request for request in harness.requests if request["request"] == "act"][-1:]
            self.assertEqual((act["on"], act["do"], act["args"]), (name, command, args))

    def test_the_state_of_a_device_is_read(self):
        states = {"robot.eye": [0.5, "inf", "-inf", "nan"], "robot.wheels": [1, 2.5, -0.5]}
        harness, node = self.node(System(states=states))
        ranges = node.laser("robot.eye").ranges()
        self.assertEqual((ranges[:3], ranges[3] != ranges[3]), ([0.5, float("inf"), float("-inf")], True))
        self.assertEqual(harness.requests[-1], {"request": "state", "device": "robot.eye", "what": "ranges"})
        self.assertEqual(node.base("robot.wheels").state("pose"), [1.0, 2.5, -0.5])
        self.assertEqual(harness.requests[-1]["what"], "pose")
        self.assertEqual({type(number) for number in node.device("robot.wheels").state("pose")}, {float})

    def test_a_name_is_one_device(self):
        _, node = self.node(System(commands=lambda request: (7, "joint 2 is at its limit")))
        self.assertIs(node.arm("robot.arm").move_to((1, 2, 3)), False)
        self.assertEqual(node.arm("robot.arm").last_error, "joint 2 is at its limit")
        self.assertIsNone(node.arm("robot.other").last_error)
        for make in (node.gripper, node.base, node.laser, node.device):
            self.assertIs(make("robot.grip"), make("robot.grip"))

    def test_outside_of_hrdsl_it_says_what_to_do(self):
        self.addCleanup(os.environ.update, {k: v for k, v in os.environ.items() if k.startswith("HRDSL_")})
        os.environ.pop("HRDSL_SEED", None)
        with self.assertRaises(hrdsl.ProtocolError) as caught:
            hrdsl.Node("test")
        self.assertIn("`hrdsl sim scenario.hri`", str(caught.exception))
        self.assertIn("`hrdsl sim scenario.hri --test NAME`", str(caught.exception))

    def test_an_event_has_its_arguments(self):
        _, node = self.node(System([(250000000, {"event": {"name": "sensed", "args": {"gaze": True}}})]))
        got = node.wait_for("sensed", timeout=1)
        self.assertEqual((got.name, got.gaze, got.args, got.time), ("sensed", True, {"gaze": True}, 0.25))
        with self.assertRaises(AttributeError):
            got.pressure
        for same in (copy.copy(got), copy.deepcopy(got), pickle.loads(pickle.dumps(got))):
            self.assertEqual(repr(same), repr(got))

    def test_after_a_stop_every_request_stops(self):
        harness, node = self.node(lambda request: {"t": 1, "stop": request["request"] == "now"})
        for _ in range(2):
            with self.assertRaises(SystemExit) as caught:
                node.now()
            self.assertIsInstance(caught.exception, hrdsl.Stopped)
        self.assertEqual(len(harness.requests), 2)  # hello, and one now

    def test_bad_values_never_leave(self):
        harness, node = self.node(lambda request: {"t": 1})
        for wrong in (
            lambda: node.sleep(float("inf")),
            lambda: node.wait_for("a", timeout=-1),
            lambda: node.arm("a").move_to((1, 2)),
            lambda: node.arm("a").command("turn", by=float("nan")),
            lambda: node.arm("a").follow([(1, 2)], (1, 2)),
            lambda: node.arm("a").follow([(1, 2), (1,)], (1, 2)),
            lambda: node.arm("a").follow([(1, 2)], (-1,)),
            lambda: node.base("a").drive(float("inf")),
            lambda: node.emit("a", x=float("nan")),
        ):
            with self.assertRaises(ValueError):
                wrong()
        self.assertEqual(len(harness.requests), 1)


class Page(unittest.TestCase):
    def test_the_page_has_all_of_it(self):
        with open(os.path.join(ROOT, "..", "..", "spec", "client-libraries.md")) as file:
            part = file.read().partition("## hrdsl\n")[2].partition("\n## ")[0]
        told = set(re.findall(r"^\| `(\w+)\.(\w+)", part, re.M)) | set(re.findall(r", `(\w+)\.(\w+)", part))
        kinds = [getattr(hrdsl, name) for name in hrdsl.__all__ if not issubclass(getattr(hrdsl, name), BaseException)]
        there = {(kind.__name__, name) for kind in kinds for name in vars(kind) if name[0] != "_" and callable(getattr(kind, name))}
        self.assertEqual(told, there)


class Coverage(unittest.TestCase):
    """`cover.combine` against coverage.py's own report of the same run."""

    def test_it_agrees_with_coverage(self):
        sys.path.append(os.environ.get("HRDSL_COVERAGE_PACKAGE", ""))
        try:
            import coverage
        except ImportError:
            self.skipTest("coverage.py is not installed")
        import fsm
        import robot

        here = os.path.dirname(os.path.abspath(__file__))
        for path in (fsm.__file__, robot.__file__, os.path.join(here, "branches.py")):
            path = os.path.abspath(path)
            with self.subTest(path=path):
                self.compare(coverage, path)

    def compare(self, coverage, path):
        measured = coverage.Coverage(branch=True, include=[path], data_file=None, config_file=False, messages=False)
        with open(path) as file:
            code = compile(file.read(), path, "exec")
        measured.start()
        space = {"__name__": "measured", "__file__": path}
        exec(code, space)
        if path.endswith("robot.py"):
            space["check_configuration"]()
            space["build"](Hardware())
            space["Statistics"](0.0).report(1.0)
        measured.stop()
        theirs = measured._analyze(path)
        kept = json.loads(json.dumps(cover.analyse(coverage, path)))
        ours = cover.combine(kept, measured.get_data().arcs(path))
        executed = sorted((a, b) for a, bs in theirs.executed_branch_arcs().items() for b in bs if a != b)
        missing = sorted((a, b) for a, bs in theirs.missing_branch_arcs().items() for b in bs if a != b)
        self.assertEqual(ours["statements"], sorted(theirs.statements))
        self.assertEqual(ours["executed"], sorted(theirs.executed & theirs.statements))
        self.assertEqual([tuple(arc) for arc in ours["executed_branches"]], executed)
        self.assertEqual([tuple(arc) for arc in ours["branches"]], sorted(executed + missing))
        self.assertTrue(missing)
        self.assertEqual(bool(executed), not path.endswith("fsm.py"))


class Hardware:
    node = None


class Machine(unittest.TestCase):
    def test_14_states_and_22_transitions(self):
        import robot

        machine = robot.build(Hardware())
        machine.check()
        self.assertEqual(len(machine.states), 14)
        self.assertEqual(len(machine.edges()), 22)
        reached, todo = set(), [machine.initial]
        while todo:
            name = todo.pop()
            if name not in reached and name in machine.states:
                reached.add(name)
                todo += machine.transitions[name].values()
        self.assertEqual(reached, set(machine.states))

    def test_a_machine_that_leads_nowhere_is_refused(self):
        import fsm

        machine = fsm.StateMachine(outcomes=["end"])
        machine.add("A", fsm.State(["go"]), {"go": "B"})
        with self.assertRaises(fsm.InvalidTransition):
            machine.execute(None)
        with self.assertRaises(fsm.InvalidTransition):
            machine.add("C", fsm.State(["go", "stay"]), {"go": "A"})


if __name__ == "__main__":
    unittest.main()
