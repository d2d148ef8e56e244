"""Mutants of robot code: each operator, what is needless, and programs that run with one."""

import ast
import json
import os
import subprocess
import sys
import tempfile
import unittest

from harness import ROOT

sys.path.insert(0, ROOT)

from hrdsl.mutation import UnknownOperator, applied, code, mutants, operators  # noqa: E402

#: Operator, source, and the sources that it makes of it.
CASES = (
    ("arithmetic", "x = a + b", ["x = a - b"]),
    ("arithmetic", "x //= 2", ["x *= 2"]),
    ("arithmetic", "x = '%s' % a", []),
    ("comparison", "x = a < b", ["x = a <= b", "x = a >= b"]),
    ("comparison", "x = a < b == c", ["x = a <= b == c", "x = a >= b == c", "x = a < b != c"]),
    ("boolean", "x = a and b", ["x = a or b"]),
    ("boolean", "x = not a", ["x = a"]),
    ("constant", "f(3)", ["f(4)", "f(2)"]),
    ("constant", "f(True)", ["f(False)"]),
    ("constant", "f(0.5)", ["f(1.5)", "f(-0.5)"]),
    ("condition", "while a:\n    f()", ["while not a:\n    f()"]),
    ("returned", "def f():\n    return 1", ["def f():\n    return None"]),
    ("returned", "def f():\n    return None", []),
    ("removed", "x = 1", ["pass"]),
    ("jump", "while a:\n    break", ["while a:\n    continue"]),
    ("swallowed", "try:\n    f()\nexcept E:\n    g()", ["try:\n    f()\nexcept E:\n    pass"]),
    ("swallowed", "raise E", ["pass"]),
    ("time", "PAUSE = 2.0", ["PAUSE = 1.0", "PAUSE = 4.0"]),
    ("time", "node.sleep(T)", ["node.sleep(T * 0.5)", "node.sleep(T * 2.0)"]),
    ("time", "LEGS = 4", []),
    ("threshold", "x = force > LIMIT", ["x = force > LIMIT * 0.9", "x = force > LIMIT * 1.1"]),
    ("threshold", "x = a > b", []),
    ("deadline", "n.wait_for('e', timeout=3)", ["n.wait_for('e')"]),
    ("check", "if a:\n    f()", ["if True:\n    f()", "if False:\n    f()"]),
    ("check", "x = a and b", ["x = b", "x = a"]),
    ("dropped", "robot.open()", ["pass"]),
    ("dropped", "log.info('x')", []),
    ("delayed", "robot.open()", ["__import__('time').sleep(1.0)\nrobot.open()"]),
    ("doubled", "robot.open()", ["robot.open()\nrobot.open()"]),
    ("reordered", "a.f()\nb.g()", ["b.g()\na.f()"]),
    ("swapped", "def f(s):\n    return s.read_gaze(), s.read_grip()", ["def f(s):\n    return s.read_grip(), s.read_gaze()"]),
    ("swapped", "def f(s):\n    return s.read('a'), s.read('a')", []),
    ("swapped", "def f(m):\n    return m.gaze, m.grip", ["def f(m):\n    return m.grip, m.gaze"]),
    ("swapped", "def f(self):\n    m = self.ask()\n    m.x()\n    return m.gaze, self.grip", []),
    ("place", "A_PLACE = (1, 2)\nB_PLACE = (3, 4)\ngo(A_PLACE)", ["A_PLACE = (1, 2)\nB_PLACE = (3, 4)\ngo(B_PLACE)"]),
    ("place", "A_PLACE = (1, 2)\ngo(A_PLACE)", []),
)


class Operators(unittest.TestCase):
    def test_makes_these_changes_and_no_others(self):
        for operator, source, expected in CASES:
            with self.subTest(operator=operator, source=source):
                made = [ast.dump(applied(ast.parse(source), m.edits)) for m in mutants(source, only=[operator])]
                self.assertEqual(made, [ast.dump(ast.parse(text)) for text in expected])

    def test_stale_readings_are_those_of_the_call_before(self):
        source = "def f(s):\n    return s.read()\n"
        (mutant,) = mutants(source, only=["stale"])
        names = {}
        exec(code(ast.parse(source), "robot.py", mutant), names)
        values = iter([1, 2, 3])
        sensor = type("Sensor", (), {"read": lambda self: next(values)})()
        self.assertEqual([names["f"](sensor) for _ in range(3)], [1, 1, 2])

    def test_every_operator_has_a_case(self):
        self.assertEqual({case[0] for case in CASES} | {"stale"}, set(operators()))

    def test_numbers_do_not_depend_on_what_is_asked_for(self):
        source = "x = a + b\nrobot.open()\nPAUSE = 2.0\n"
        numbers = {m.number: m.what for m in mutants(source)}
        for name in operators():
            for mutant in mutants(source, only=[name]):
                self.assertEqual(numbers[mutant.number], mutant.what)

    def test_lines_are_those_of_the_statements_that_change(self):
        source = "x = f(\n    1,\n    a < 2)\nrobot.open()\nrobot.go(\n    3)\ntry:\n    g()\nexcept E:\n    h()\n"
        lines = {(m.operator, m.what): m.lines for m in mutants(source)}
        self.assertEqual(lines["comparison", "< becomes <="], [1])
        self.assertEqual(lines["reordered", "open is called after the next statement"], [4, 5])
        self.assertEqual(lines["constant", "3 becomes 4"], [5])
        self.assertEqual(lines["swallowed", "the exception is swallowed"], [9])

    def test_the_original_is_left_alone(self):
        source = "if a and b < 3:\n    robot.open()\n    robot.go(x)\n"
        tree = ast.parse(source)
        for mutant in mutants(source):
            applied(tree, mutant.edits)
        self.assertEqual(ast.dump(tree), ast.dump(ast.parse(source)))

    def test_unknown_operators_are_told_the_nearest(self):
        with self.assertRaisesRegex(UnknownOperator, "did you mean `deadline`"):
            mutants("x = 1", only=["dedline"])


class Needless(unittest.TestCase):
    def test_same_bytecode_as_the_original(self):
        found = mutants("def f():\n    if False and g():\n        return 1\n", only=["returned"])
        self.assertEqual([m.needless for m in found], ["equivalent"])

    def test_same_bytecode_as_an_earlier_mutant(self):
        found = mutants("def f(a):\n    if a:\n        g()\n", only=["check", "condition", "dropped"])
        self.assertEqual({m.what: m.needless for m in found}["the check is always False"], "")
        found = [m for m in mutants("f(not True)\n") if m.operator == "boolean" or m.what == "True becomes False"]
        self.assertEqual([m.needless for m in found], ["", "duplicate"])
        found = mutants("PAUSE = 1.0\n", only=["constant", "time"])
        self.assertEqual({m.what: m.needless for m in found}["1.0 becomes 2.0"], "duplicate")

    def test_types_of_constants_count(self):
        found = mutants("f(False)\nf(0)\n", only=["constant"])
        self.assertEqual([m.needless for m in found], ["", "", ""])


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.write("main.py", "import sys\nfrom part import size\nprint(size(), sys.argv[1:])\n")
        self.write("part.py", "def size():\n    return 2 + 1\n")

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def call(self, *args):
        env = {**os.environ, "PYTHONPATH": ROOT, "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-m", "hrdsl.mutation", *args]
        return subprocess.run(command, cwd=self.folder, env=env, capture_output=True, text=True, timeout=60)

    def test_runs_a_module_and_a_program_with_a_mutant(self):
        listed = json.loads(self.call("list", "part.py", "--operator", "arithmetic", "--json").stdout)["mutants"]
        done = self.call("run", "part.py", str(listed[0]["number"]), "--", "main.py", "--legs", "2")
        self.assertEqual((done.stdout, done.returncode), ("1 ['--legs', '2']\n", 0), done.stderr)
        self.write("alone.py", "if __name__ == '__main__':\n    print(2 + 1)\n")
        (mutant,) = json.loads(self.call("list", "alone.py", "--operator", "arithmetic", "--json").stdout)["mutants"]
        self.assertEqual(self.call("run", "alone.py", str(mutant["number"]), "--", "alone.py").stdout, "1\n")
        with open(os.path.join(self.folder, "part.py"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "def size():\n    return 2 + 1\n")

    def test_what_the_program_raises_is_its_own(self):
        self.write("raises.py", "x = 1\nprint({}[7])\n")
        (mutant,) = json.loads(self.call("list", "raises.py", "--operator", "removed", "--json").stdout)["mutants"]
        done = self.call("run", "raises.py", str(mutant["number"]), "--", "raises.py")
        self.assertEqual(done.returncode, 1)
        self.assertIn("KeyError: 7", done.stderr)

    def test_the_sentinel_raises_at_once(self):
        for file in ("part.py", "main.py"):
            done = self.call("run", file, "0", "--", "main.py")
            self.assertEqual((done.stdout, done.returncode), ("", 1))
            self.assertIn("the sentinel mutant ends at once", done.stderr)

    def test_a_package_has_its_mutant(self):
        os.mkdir(os.path.join(self.folder, "parts"))
        self.write("parts/__init__.py", "from parts.more import size\n")
        self.write("parts/more.py", "def size():\n    return 3\n")
        self.write("whole.py", "import parts\nprint(parts.size())\n")
        self.assertEqual(self.call("run", "main.py", "0", "--", "whole.py").stdout, "3\n")
        for file in ("parts/__init__.py", "parts/more.py"):
            done = self.call("run", file, "0", "--", "whole.py")
            self.assertIn("the sentinel mutant ends at once", done.stderr, file)
            self.assertNotIn("did not import", done.stderr)

    def test_a_mutant_that_changed_nothing_is_told(self):
        self.write("apart.py", "print(1)\n")
        done = self.call("run", "part.py", "0", "--", "apart.py")
        self.assertEqual(done.stdout, "1\n")
        self.assertIn("the program did not import", done.stderr)

    def test_compiled_mutants_take_the_place_of_their_file(self):
        listed = json.loads(self.call("list", "part.py", "--operator", "arithmetic", "--json").stdout)["mutants"]
        number = listed[0]["number"]
        done = self.call("codes", "--to", self.folder, "--", "part.py", str(number), "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        program = "import sys; from hrdsl.mutated import chosen; sys.meta_path.insert(0, chosen(sys.argv[1])); import part; print(part.size())"
        for name, printed in ((str(number), "1\n"), ("original", "3\n"), ("0", "")):
            words = json.dumps({"file": "part.py", "code": os.path.join(self.folder, name + ".code")})
            env = {**os.environ, "PYTHONPATH": ROOT, "PYTHONDONTWRITEBYTECODE": "1"}
            command = [sys.executable, "-c", program, words]
            done = subprocess.run(command, cwd=self.folder, env=env, capture_output=True, text=True, timeout=60)
            self.assertEqual(done.stdout, printed, done.stderr)
        self.assertIn("part.py", done.stderr, "tracebacks name the file")

    def test_lists_are_kept_for_one_text(self):
        first = self.call("list", "part.py", "--json", "--cache", self.folder).stdout
        (kept,) = [name for name in os.listdir(self.folder) if name.endswith(".json")]
        self.assertEqual(self.call("list", "part.py", "--json", "--cache", self.folder).stdout, first)
        with open(os.path.join(self.folder, kept), encoding="utf-8") as file:
            found = json.load(file)
        self.write(kept, json.dumps(found[:1]))
        self.assertIn("1 mutants", self.call("list", "part.py", "--cache", self.folder).stdout, "what is kept is used")
        self.write("part.py", "def size():\n    return 2 - 1\n")
        changed = self.call("list", "part.py", "--json", "--cache", self.folder).stdout
        self.assertIn("- becomes +", changed)

    def test_bad_input_is_named(self):
        self.write("broken.py", "x = (\n")
        for args, part in (
            (("list", "broken.py"), "broken.py:1: "),
            (("list", "absent.py"), "absent.py"),
            (("list", "part.py", "--operator", "tiem"), "did you mean `time`"),
            (("run", "part.py", "999", "--", "main.py"), "not 999"),
        ):
            done = self.call(*args)
            self.assertEqual(done.returncode, 2, args)
            self.assertIn(part, done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
