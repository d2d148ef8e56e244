"""At which lines a program is when: what is kept, and what is too much."""

import itertools
import json
import os
import tempfile
import unittest

from harness import run
from test_cover import PACKAGE, is_installed

SCRIPT = """\
import threading, time
import helper


def other():
    helper.wait(0.5)
    helper.wait(2)


thread = threading.Thread(target=other, name="other")
thread.start()
for _ in range(3):
    time.sleep(1)
time.sleep(1)
thread.join()
"""

HELPER = """\
import time


def wait(seconds):
    time.sleep(seconds)
"""

MANY = """\
import threading, time
from hrdsl import lines

lines.MOST_LINES = 500


def one(n):
    time.sleep(n + 1)


for n in range(60):
    threading.Thread(target=one, args=(n,)).start()
while time.monotonic() < 1000:
    time.sleep(1)
    time.sleep(1)
"""


@unittest.skipUnless(is_installed(), "coverage.py is not installed")
class Lines(unittest.TestCase):
    def lines(self, script, covered=("script.py",), more=(("HRDSL_LINES", "1"),)):
        """What a script leaves: its coverage, and its lines, if there are any."""
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as out:
            for name, text in (("script.py", script), ("helper.py", HELPER)):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(text)
            env = {"HRDSL_COVERAGE_PACKAGE": PACKAGE, "HRDSL_COVERAGE_CACHE": folder, **dict(more)}
            env["HRDSL_COVERAGE_FD"] = str(out.fileno())
            options = [word for name in covered for word in ("--coverage", name)]
            finished = run(["script.py"], options=options, keep=[out.fileno()], env=env, cwd=folder)
            self.assertEqual((finished.code, finished.err), (0, ""))
            out.seek(0)
            coverage, *lines = out.read().splitlines()
        self.assertEqual(sorted(json.loads(coverage)), sorted(covered))
        return [json.loads(line) for line in lines]

    def told(self, lines):
        """Of each thread the tenths of seconds, files and lines."""
        added = {each["name"]: [list(itertools.accumulate(each[key])) for key in ("t", "file", "line")] for each in lines["threads"]}
        return {name: list(zip([t // 10**8 for t in times], *more)) for name, (times, *more) in added.items()}

    def test_each_thread_has_the_line_at_which_it_waits(self):
        (lines,) = self.lines(SCRIPT)
        self.assertEqual([each["name"] for each in lines["files"]], ["script.py"])
        self.assertEqual((lines["until"], lines["unseen"]), (None, 0))
        told = self.told(lines)
        self.assertEqual(told["MainThread"][-3:], [(0, 0, 13), (30, 0, 14), (40, 0, 0)], "once each, though it slept there thrice")
        self.assertEqual(told["other"], [(0, 0, 6), (5, 0, 7)], "the innermost line of the files that are asked for")

    def test_a_file_that_is_asked_for_comes_before_its_caller(self):
        (lines,) = self.lines(SCRIPT, ("script.py", "helper.py"))
        self.assertEqual(self.told(lines)["other"], [(0, 1, 5)])
        self.assertEqual(len({each["crc"] for each in lines["files"]}), 2)

    def test_without_being_asked_there_are_none(self):
        self.assertEqual(self.lines(SCRIPT, more=()), [])

    def test_what_is_too_much_is_said(self):
        (lines,) = self.lines(MANY)
        self.assertEqual((len(lines["threads"]), lines["unseen"]), (50, 11))
        kept = self.told(lines)
        self.assertEqual(sum(len(each) for each in kept.values()), 500)
        self.assertTrue(400 * 10**9 < lines["until"] < 500 * 10**9, lines["until"])


if __name__ == "__main__":
    unittest.main()
