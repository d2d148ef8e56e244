"""How programs are started that are to be nodes, and what is said of those that cannot be."""

import os
import tempfile
import unittest

from harness import run
from tables import bound

NODE = """
import rospy, sys
def main():
    rospy.init_node("node")
    print(rospy.get_name(), sys.argv, __name__)
"""


KNOT = """
import smach, threading
lock = threading.Lock()
class Give(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["given"])
    def execute(self, userdata):
        lock.acquire()
        return "given"
with lock:
    both = smach.Concurrence(outcomes=["done"], default_outcome="done")
    with both: smach.Concurrence.add("GIVE", Give())
    both.execute(smach.UserData())
"""


class Starting(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        os.mkdir("tea")
        self.write("tea/__init__.py", "")
        self.write("tea/brain.py", NODE)
        self.environment = bound(folder.name, ("std_msgs", "dynamic_reconfigure"))

    def write(self, name, text):
        with open(name, "w") as file:
            file.write(text)

    def run_(self, *words, **environment):
        return run(list(words), env={**self.environment, **environment})

    def test_code_in_the_command(self):
        finished = self.run_("-c", "from tea.brain import main; main()", "__ns:=/bar")
        self.assertEqual((finished.code, finished.err), (0, ""))
        self.assertEqual(finished.out, "/bar/node ['-c', '__ns:=/bar'] tea.brain\n")
        finished = self.run_("-c", "1 / 0")
        self.assertEqual(finished.code, 1)
        self.assertIn('File "<string>", line 1, in <module>\nZeroDivisionError', finished.err)
        self.assertNotIn("runner.py", finished.err)

    def test_a_main_that_nobody_calls(self):
        for words, told in (
            (["-m", "tea.brain"], "start it with `python3 -c 'from tea.brain import main; main()'`"),
            (["tea/brain.py"], 'its last line would be `if __name__ == "__main__": main()`'),
        ):
            finished = self.run_(*words)
            told = "hrdsl: %s defines main(), and nobody calls it: %s\n" % (words[-1], told)
            self.assertEqual((finished.code, finished.out, finished.err), (1, "", told))

    def test_those_that_do_as_they_should_end_in_silence(self):
        self.write("tea/brain.py", NODE + 'if __name__ == "__main__":\n    main()\n')
        self.write("tea/__main__.py", "from tea.brain import main\nmain()\n")
        self.write("usage.py", "def main(word=None):\n    print('usage')\nif __name__ == '__main__':\n    main()\n")
        self.write("plain.py", "print('no node')\n")
        for words, out in (
            (["tea/brain.py"], "/node ['tea/brain.py'] __main__\n"),
            (["-m", "tea.brain"], None),
            (["-m", "tea"], None),
            (["usage.py"], "usage\n"),
            (["plain.py"], "no node\n"),
        ):
            finished = self.run_(*words)
            self.assertEqual((finished.code, finished.err), (0, ""))
            self.assertTrue(finished.out if out is None else finished.out == out, finished.out)
        self.write("tea/brain.py", "def main():\n    pass\n")
        self.assertEqual(self.run_("tea/brain.py", HRDSL_MIDDLEWARE="").code, 1)
        self.environment = {}
        self.assertEqual(self.run_("tea/brain.py").code, 0)

    def test_modules_of_ros_that_are_not_there(self):
        for name, told in (
            ("cv_bridge", "hrdsl: `cv_bridge` is not there without ROS: the pixels of an image are in its `data`"),
            ("rclpy", "hrdsl: `rclpy` is there for programs of a system that has a block `ros2 { }`, and this one has `ros1`"),
            ("dynamic_reconfigure.server", "hrdsl: `dynamic_reconfigure.server` is not there without ROS: "),
            ("husky_msgs.msg", "husky_msgs` into requirements.txt beside the scenario (or the package that has it), or, if it is a"),
        ):
            finished = run(["-c", "import %s" % name], env=self.environment)
            self.assertEqual(finished.code, 1)
            self.assertIn(told, finished.err.splitlines()[-1])
        finished = run(["-c", "import rospy"], env={"HRDSL_SYS_PATH": ""})
        self.assertIn("`rospy` is there for programs of a system that has a block `ros1 { }`\n", finished.err)

    def test_modules_of_a_package_that_lie_elsewhere(self):
        os.makedirs("lib/dynamic_reconfigure")
        self.write("lib/dynamic_reconfigure/__init__.py", "")
        self.write("lib/dynamic_reconfigure/names.py", "BREW = 1")
        told = (
            "hrdsl: `dynamic_reconfigure` is at lib/dynamic_reconfigure, where no module is looked for: add `env PYTHONPATH` to "
            "the system, and start it with `PYTHONPATH=lib hrdsl sim`\n"
        )
        for text in ("from dynamic_reconfigure import names", "import dynamic_reconfigure.names"):
            finished = self.run_("-c", text)
            self.assertEqual((finished.code, finished.err[-len(told) :]), (1, told))
            self.assertEqual(self.run_("-c", text + "\nimport dynamic_reconfigure.msg", PYTHONPATH="lib").err, "")
        finished = self.run_("-c", "from dynamic_reconfigure import other")
        self.assertNotIn("hrdsl: ", finished.err)
        finished = self.run_("-c", "from dynamic_reconfigure.msg import Other")
        self.assertNotIn("hrdsl: ", finished.err)
        self.write("tea/brain.py", "import kettle")
        self.write("lib/kettle.py", "")
        finished = self.run_("tea/brain.py")
        told = (
            'hrdsl: `kettle` is at lib/kettle.py, where no module is looked for: add `sys.path.append("lib")` before the import, '
            "or `env PYTHONPATH` to the system, and start it with `PYTHONPATH=lib hrdsl sim`"
        )
        self.assertEqual(finished.err.splitlines()[-1], told)

    def test_a_deadlock_is_told_at_the_line_of_the_program(self):
        self.write("knot.py", KNOT)
        finished = self.run_("knot.py")
        self.assertEqual(finished.code, 1)
        self.assertRegex(finished.err, r"thread MainThread waits in Concurrence.execute at .*/knot.py:13")
        self.assertRegex(finished.err, r"waits in Lock at .*/knot.py:8, held by thread MainThread")
        self.assertNotIn("concurrence.py", finished.err.partition("Traceback")[0])


if __name__ == "__main__":
    unittest.main()
