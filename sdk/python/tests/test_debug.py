"""`breakpoint()` with and without a terminal."""

import json
import os
import pty
import select
import sys
import tempfile
import unittest

from harness import run

HERE = os.path.dirname(os.path.abspath(__file__))

PROGRAM = """\
import time
import hrdsl
node = hrdsl.Node("robot")
x = 41
breakpoint()
node.sleep(1)
print("after", x, time.time())
"""

#: As `hrdsl sim` starts programs: in a process group of their own, in the background of the terminal.
SESSION = """\
import json, os, sys
sys.path.insert(0, %r)
from harness import run
done = run(sys.argv[2:], env={"HRDSL_DEBUG": "1"}, preexec_fn=os.setpgrp)
with open(sys.argv[1], "w") as file:
    json.dump([done.code, done.out, done.err, [one["request"] for one in done.requests]], file)
print("back on the terminal")
"""


class Debug(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def script(self, text):
        path = os.path.join(self.folder, "program.py")
        with open(path, "w") as file:
            file.write(text)
        return path

    def on_a_terminal(self, text, typed):
        """What the terminal showed, and how the program ended."""
        found = os.path.join(self.folder, "found")
        words = [sys.executable, "-c", SESSION % HERE, found, self.script(text)]
        child, terminal = pty.fork()
        if child == 0:
            os.environ["TERM"] = "dumb"
            os.execv(sys.executable, words)
        shown = b""
        try:
            while select.select([terminal], [], [], 60)[0]:
                shown += os.read(terminal, 1 << 16)
                if shown.count(b"(Pdb) ") and typed and shown.endswith(b"(Pdb) "):
                    os.write(terminal, typed.pop(0).encode() + b"\n")
        except OSError:
            pass  # its end
        os.waitpid(child, 0)
        os.close(terminal)
        with open(found) as file:
            return shown.decode(), json.load(file)

    def test_the_debugger_is_on_the_terminal(self):
        shown, found = self.on_a_terminal(PROGRAM, ["p x + 1", "x = 5", "n", "import sys; print('see', sys.stdin.isatty())", "c"])
        self.assertIn("42", shown)
        self.assertIn("see True", shown)
        self.assertIn("back on the terminal", shown)
        self.assertEqual(found, [0, "after 5 1735689601.0\n", "", ["hello", "wait", "done"]])

    def test_all_ways_into_the_debugger_are_on_the_terminal(self):
        text = PROGRAM.replace("breakpoint()", "import pdb; pdb.set_trace()") + "try:\n    1 / 0\nexcept ArithmeticError:\n    pdb.post_mortem()\n"
        shown, found = self.on_a_terminal(text, ["c", "p x + 2", "c"])
        self.assertIn("43", shown)
        self.assertEqual((found[0], found[3]), (0, ["hello", "wait", "done"]), found)

    def test_who_leaves_the_debugger_ends_the_program(self):
        _, found = self.on_a_terminal(PROGRAM, ["q", "y"])
        self.assertEqual((found[0], found[1], found[3]), (1, "", ["hello"]), found)
        self.assertNotIn("Traceback", found[2])

    def test_without_a_debugger_it_says_how_to_have_one(self):
        for stop in ("breakpoint()", "import pdb; pdb.set_trace()"):
            finished = run([self.script(PROGRAM.replace("breakpoint()", stop))])
            self.assertEqual((finished.code, finished.out), (1, ""))
            self.assertRegex(finished.err.splitlines()[-1], "^RuntimeError: .*`hrdsl sim --test NAME --debug`$")

    def test_without_a_terminal_it_says_so(self):
        finished = run([self.script(PROGRAM)], env={"HRDSL_DEBUG": "1"}, start_new_session=True)
        self.assertIn("RuntimeError: there is no terminal to debug the program on: /dev/tty: ", finished.err)
        self.assertEqual(finished.code, 1)

    def test_the_debugger_and_coverage_do_not_meet(self):
        script = self.script("import hrdsl\nhrdsl.Node('robot')\n")
        with tempfile.TemporaryFile() as out:
            env = {"HRDSL_DEBUG": "1", "HRDSL_COVERAGE_FD": str(out.fileno())}
            finished = run([script], options=["--coverage", script], keep=[out.fileno()], env=env)
            out.seek(0)
            self.assertEqual((finished.code, finished.err, out.read()), (0, "", b""))

    def test_breakpoints_can_be_turned_off(self):
        finished = run([self.script(PROGRAM)], env={"PYTHONBREAKPOINT": "0"})
        self.assertEqual((finished.code, finished.out, finished.err), (0, "after 41 1735689601.0\n", ""))


if __name__ == "__main__":
    unittest.main()
