"""The page about the client libraries against them: what it names is there and used by a test, and what it calls refused is."""

import glob
import os
import re
import unittest

from harness import ROOT
from ros2_programs import run_ros2
from system import System
from tables import run_ros

from hrdsl import advice

PAGE = os.path.join(ROOT, "..", "..", "spec", "client-libraries.md")
HERE = os.path.dirname(os.path.abspath(__file__))

#: What of all packages the programs of this test import.
PACKAGES = ("std_msgs", "moveit_msgs", "geometry_msgs", "sensor_msgs", "actionlib_msgs", "tf2_msgs", "shape_msgs", "diagnostic_msgs")

LOOKS = """
import importlib
def told(call):
    try:
        return call()
    except NotImplementedError as error:
        return "refused: %s" % error
    except Exception as error:
        return "%s: %s" % (type(error).__name__, error)
def there(module, name):
    found = importlib.import_module(module)
    for part in name.split("."):
        found = getattr(found, part)
    return "there"
def ran(code):
    if code.startswith("import "):
        return importlib.import_module(code[7:])
    return eval(code)
"""

ROS1 = LOOKS + """
import moveit_commander, moveit_msgs.msg, rosgraph, rospkg, rospy, smach_ros, tf.transformations, tf2_ros, tf_conversions
rospy.init_node("node")
group = moveit_commander.MoveGroupCommander("arm")
"""

ROS2 = LOOKS + """
import launch, launch_ros.actions, rclpy, rclpy.qos_event, rclpy.time, ros2cli.node.strategy, ros2topic.api, tf2_ros
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("node")
"""

GROUPS = {"arm": {"device": "robot.arm", "joints": [{"name": "hip", "lower": -1.5, "upper": 1.5, "velocity": 0.8}]}}


def rows(mark):
    """The rows of the table behind a mark, as lists of what stands between backquotes in each cell."""
    with open(PAGE) as file:
        part = file.read().partition("<!-- %s -->" % mark)[2].partition("<!--")[0]
    lines = [line for line in part.splitlines() if line.startswith("|")][2:]
    return [[re.findall(r"`([^`]*)`", cell) for cell in line.strip("|").split(" | ")] for line in lines]


class Page(unittest.TestCase):
    maxDiff = None

    def said(self, ros, text):
        if ros == "ros1":
            finished = run_ros(ROS1 + text, PACKAGES, System(states={"robot.arm": [0.0]}), binding={"groups": GROUPS})
        else:
            finished = run_ros2(ROS2 + text)
        self.assertEqual(finished.code, 0, finished.err)
        return finished.out.splitlines()

    def test_what_it_names_is_there(self):
        for ros in ("ros1", "ros2"):
            names = [(module, name) for (module,), given in rows("there " + ros) for name in given]
            self.assertGreater(len(names), 90)
            names = [pair for pair in names if pair[0] != "sensor_msgs_py.point_cloud2"]  # which needs NumPy
            said = self.said(ros, "for pair in %r: print(pair, told(lambda: there(*pair)))" % names)
            self.assertEqual(said, ["%r there" % (pair,) for pair in names])

    def test_what_it_names_is_tested(self):
        texts = {"ros1": "", "ros2": ""}
        for path in glob.glob(os.path.join(HERE, "test_*.py")):
            with open(path) as file:
                text = file.read()
            if path != os.path.abspath(__file__):
                name = os.path.basename(path)
                for ros in texts:
                    is_other = name.startswith("test_rclpy") if ros == "ros1" else re.match("test_(rospy|smach|tf|moveit|action|genpy)", name)
                    texts[ros] += "" if is_other else text
        for ros, text in texts.items():
            missing = [
                "%s.%s" % (module, name)
                for (module,), given in rows("there " + ros)
                for name in given
                if not re.search(r"\b%s\b" % name.rpartition(".")[2], text)
            ]
            self.assertEqual(missing, [])

    def test_what_is_refused(self):
        for ros in ("ros1", "ros2"):
            codes = [code for _, (code,) in rows("refused " + ros)]
            self.assertGreater(len(codes), 9)
            said = self.said(ros, "for code in %r: print(told(lambda: ran(code)))" % codes)
            self.assertEqual([code for code, line in zip(codes, said) if not line.startswith("refused: ")], [])
            self.assertEqual([line for line in said if len(line) < 50], [], "too short to say what to do")

    def test_modules_that_are_not_there(self):
        with open(PAGE) as file:
            text = file.read()
        self.assertEqual([module for (module,), *_ in rows("absent")], sorted(advice.ABSENT))
        for module, instead in advice.ABSENT.items():
            self.assertIn("| `%s` | %s |" % (module, instead), text)
            for ros in ("ros1", "ros2"):
                self.assertFalse(os.path.exists(os.path.join(ROOT, ros, *module.split("."))), module)


if __name__ == "__main__":
    unittest.main()
