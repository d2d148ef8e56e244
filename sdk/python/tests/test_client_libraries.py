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
import actionlib, moveit_commander, moveit_msgs.msg, rosgraph, rospkg, rospy, smach_ros, tf.transformations, tf2_ros, tf_conversions
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


#: What makes an object of a class besides the class itself.
MAKERS = {
    "Publisher": ["create_publisher"], "Client": ["create_client"], "Timer": ["create_timer"], "Rate": ["create_rate"],
    "Node": ["create_node"], "Future": ["call_async", "create_task", "send_goal_async"], "Clock": ["get_clock"],
    "Executor": ["SingleThreadedExecutor", "MultiThreadedExecutor"], "Time": ["now", "from_msg"],
}  # fmt: skip


def texts_of(ros):
    """The tests of the libraries for one ROS: their programs are texts in them, or files beside them."""
    with open(os.path.join(HERE, "ros2_programs.py")) as file:
        begin = file.read() if ros == "ros2" else ""  # of programs that are written into the tests
    paths = glob.glob(os.path.join(HERE, "test_*.py"))
    other = "test_rclpy" if ros == "ros1" else "test_(rospy|smach|tf|moveit|action|genpy)"
    if ros == "ros1":
        paths += glob.glob(os.path.join(HERE, "rospy_programs", "*.py"))
    for path in paths:
        if path != os.path.abspath(__file__) and not re.match(other, os.path.basename(path)):
            with open(path) as file:
                yield begin + file.read()


def uses(text, module, name):
    """Whether a text uses what the module has under the name: by the module, by an import from it, or on an object that it makes."""
    kind, _, own = name.rpartition(".")
    if kind:
        return uses_method(text, kind, own)
    if own.endswith(("Exception", "Error")) and re.search(r"\b%s\b" % own, text):
        return True  # programs print what they catch
    package, _, last = module.rpartition(".")
    known = {module, last or module} | set(re.findall(r"\bimport %s as (\w+)" % re.escape(module), text))
    known |= set(re.findall(r"\bfrom %s import %s as (\w+)" % (re.escape(package), last), text))
    if re.search(r"(?<![\w.])(?:%s)\.%s\b" % ("|".join(map(re.escape, known)), own), text):
        return True
    used = len(re.findall(r"(?<![\w.])%s\b" % own, text))
    begin = r"\bfrom %s[\w.]* import " % re.escape(module.partition(".")[0])
    return used > 1 and bool(re.search(begin + r"[^\n]*\b%s\b" % own, text)) or used > 0 and bool(re.search(begin + r"\*", text))


def uses_method(text, kind, own):
    """Whether it is called on an object of the class, or of one derived from it, or defined in such a one for the library to call."""
    derived = re.findall(r"\bclass (\w+)\([^)\n]*\b%s\b" % kind, text)
    if derived and re.search(r"\bdef %s\(self\b|\bself\.%s\(" % (own, own), text):
        return True
    makers = "|".join([kind, *MAKERS.get(kind, ()), *derived])
    made = r"\b(?:%s)\(" % makers
    if re.search(r"\b(?:%s)\.%s\b|%s[^\n]*\)\.%s\b" % (makers, own, made, own), text):
        return True
    given = re.findall(r"(?:^|; )[ ]*([\w., ]+?) = [^\n]*?" + made, text, re.M) + re.findall(made + r"[^\n]*\) as (\w+)", text)
    names = {name.strip() for names in given for name in names.split(",")}
    return any(re.search(r"(?<![\w.])%s\.%s\b" % (re.escape(name), own), text) for name in names if name)


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
        for ros in ("ros1", "ros2"):
            texts = list(texts_of(ros))
            named = [(module, name) for (module,), given in rows("there " + ros) for name in given]
            self.assertEqual([pair for pair in named if not any(uses(text, *pair) for text in texts)], [])

    def test_a_word_alone_is_no_use(self):
        text = "import threading, rospy\nfrom actionlib import SimpleActionServer\nthreading.Thread().start()\nclient.call(1)\nsleep(1)"
        for module, name in (("actionlib", "SimpleActionServer.start"), ("rospy", "ServiceProxy.call"), ("rospy", "sleep")):
            self.assertFalse(uses(text, module, name), name)
        text += "\nserver = SimpleActionServer('a')\nserver.start()\nrospy.ServiceProxy('a', B).call(1)\nrospy.sleep(1)"
        for module, name in (("actionlib", "SimpleActionServer.start"), ("rospy", "ServiceProxy.call"), ("rospy", "sleep")):
            self.assertTrue(uses(text, module, name), name)

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
