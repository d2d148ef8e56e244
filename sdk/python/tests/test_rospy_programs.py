"""Small programs of ROS 1, which print here what they print with ROS itself: rospy_programs/README.md says how that was found out.

Where a program departs from that, it says so; `HRDSL_UPDATE=1 python3 test_rospy_programs.py` writes what it prints here instead."""

import importlib.util
import os
import tempfile
import unittest

from harness import ROOT, run
from rospy_text import Head, kept
from system import System
from tables import bound

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rospy_programs")
PAGE = os.path.join(ROOT, "..", "..", "spec", "client-libraries.md")
PACKAGES = ("actionlib", "actionlib_msgs", "geometry_msgs", "nav_msgs", "roscpp", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs", "tf2_msgs",
            "trajectory_msgs")  # fmt: skip
NAMES = sorted(name[:-3] for name in os.listdir(FOLDER) if name.endswith(".py") and name != "record.py")


def text_of(name, end):
    path = os.path.join(FOLDER, name + end)
    if not os.path.exists(path):
        return ""
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(name, end, text):
    path = os.path.join(FOLDER, name + end)
    if text:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    elif os.path.exists(path):
        os.remove(path)


class Programs(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.environment = bound(folder.name, PACKAGES)

    def check(self, name):
        head = Head(text_of(name, ".py"))
        for module in head.needs:
            if importlib.util.find_spec(module) is None:
                self.skipTest("%s is not installed" % module)
        words = [os.path.join(FOLDER, name + ".py"), *head.arguments]
        # A program that waits for what never comes would run on; a thousand seconds are enough for each.
        finished = run(words, system=System(end=10**12), env={**self.environment, "PYTHONIOENCODING": "utf-8", **head.environment})
        said = {".out": kept(finished.out, FOLDER), ".err": kept(finished.err, FOLDER) if head.has_stderr else ""}
        recorded = {end: text_of(name, end) for end in said}
        if head.departs:
            self.assertNotEqual(said, recorded, "it departs no more")
            if os.environ.get("HRDSL_UPDATE"):
                for end in said:
                    write(name, ".departs" + end, said[end] if said[end] != recorded[end] else "")
            recorded = {end: text_of(name, ".departs" + end) or recorded[end] for end in said}
        for end in said:
            self.assertEqual(said[end], recorded[end], finished.err)
        self.assertEqual(finished.code, head.code, finished.err)

    def test_each_departure_is_on_the_page(self):
        with open(PAGE, encoding="utf-8") as file:
            page = file.read()
        for name in NAMES:
            for sentence in Head(text_of(name, ".py")).departs:
                self.assertIn(sentence, page, name)

    def test_each_output_has_its_program(self):
        files = [name for name in os.listdir(FOLDER) if name.endswith((".out", ".err"))]
        self.assertEqual(sorted({name.split(".")[0] for name in files} - set(NAMES)), [])
        self.assertEqual([name for name in NAMES if not text_of(name, ".out") + text_of(name, ".err")], [])


def _test(name):
    return lambda self: self.check(name)


for _name in NAMES:
    setattr(Programs, "test_of_" + _name, _test(_name))


if __name__ == "__main__":
    unittest.main()
