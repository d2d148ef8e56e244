"""Callbacks that raise: the node goes on as in ROS, and the harness is told."""

import unittest

from ros2_programs import run_ros2
from system import System
from tables import run_ros

SECOND = 10**9


def numbers(*values):
    """Messages of /numbers, one each second."""
    return [((n + 1) * SECOND, {"topic": "/numbers", "message": {"data": value}}) for n, value in enumerate(values)]


class Rospy(unittest.TestCase):
    def failures(self, text, arrivals=(), **more):
        """What the harness is told by a program, each with the time in seconds; and what became of it."""
        system = System(arrivals, end=20 * SECOND, **more)
        finished = run_ros("import functools, rospy, threading, time\nfrom std_msgs.msg import *\n" + text, ["std_msgs", "std_srvs"], system=system)
        self.assertEqual(finished.code, 0, finished.err)
        return [(time / SECOND, node, told) for time, node, told in system.failures], finished

    def test_of_a_subscriber(self):
        text = """
def hear(message):
    print("hears", message.data)
    if message.data == 1:
        raise ValueError("number %d" % message.data)
    if message.data == 2:
        raise NotImplementedError("no twos")
class Robot:
    def hear(self, message, word):
        import cv_bridge
rospy.init_node("brain")
kept = [rospy.Subscriber("numbers", Int8, hear), rospy.Subscriber("numbers", Int8, functools.partial(Robot().hear), "word")]
rospy.sleep(10)
print("goes on")
"""
        told, finished = self.failures(text, numbers(0, 1, 2))
        of = "subscriber of /numbers (std_msgs/Int8): "
        self.assertEqual([each for each in told if "cv_bridge" not in each[2]], [
            (2.0, "/brain", of + "hear raised ValueError: number 1"),
            (3.0, "/brain", of + "hear raised NotImplementedError: no twos"),
        ])  # fmt: skip
        missing = [text for _, _, text in told if "cv_bridge" in text]
        self.assertEqual(len(missing), 3)
        self.assertTrue(missing[0].startswith(of + "Robot.hear raised ModuleNotFoundError: No module named 'cv_bridge'; `cv_b"), missing[0])
        self.assertEqual(finished.out.splitlines(), ["hears 0", "hears 1", "hears 2", "goes on"])
        self.assertEqual(finished.err.count("bad callback: "), 5)

    def test_of_a_timer_and_of_what_was_refused_later(self):
        text = """
def tick(event):
    raise RuntimeError
def say(event):
    bad.tell(b'{"request":"refused"}\\n', "publisher of /bad")
rospy.init_node("brain")
from hrdsl.link import the_link
bad = the_link()
timers = [rospy.Timer(rospy.Duration(0.5), tick), rospy.Timer(rospy.Duration(1), say, oneshot=False)]
rospy.sleep(10)
print([timer.is_alive() for timer in timers])
"""

        def refuse(system):
            def tell(request):
                system.refused.append({"line": system.lines, "error": "it is refused"})

            system.tell_refused = tell

        told, finished = self.failures(text, [(0, refuse)])
        self.assertEqual(told, [
            (0.5, "/brain", "timer of 0.5 s: tick raised RuntimeError"),
            (1.0, "/brain", "timer of 1 s: say raised ProtocolError: publisher of /bad: it is refused"),
        ])  # fmt: skip
        self.assertEqual(finished.out, "[False, False]\n")
        self.assertEqual(finished.err.count("Traceback"), 2)

    def test_of_filters_and_listeners(self):
        text = """
import message_filters
class Watch(rospy.SubscribeListener):
    def peer_subscribe(self, name, all, one):
        raise KeyError("peer")
def both(a, b):
    raise ValueError("both")
rospy.init_node("brain")
filters = [message_filters.Subscriber("numbers", Int8) for _ in range(2)]
message_filters.ApproximateTimeSynchronizer(filters, 5, 1.0, allow_headerless=True).registerCallback(both)
pub = rospy.Publisher("said", Int8, subscriber_listener=Watch(), queue_size=1)
sub = rospy.Subscriber("said", Int8)
rospy.sleep(5)
"""
        told, _ = self.failures(text, numbers(1))
        self.assertEqual(told, [
            (0.0, "/brain", "publisher of /said (std_msgs/Int8): its listener raised KeyError: 'peer'"),
            (1.0, "/brain", "subscriber of /numbers (std_msgs/Int8): Subscriber.callback raised ValueError: both"),
        ])  # fmt: skip

    def test_nothing_is_told_where_others_hear_of_it_or_the_node_is_over(self):
        text = """
from std_srvs.srv import Trigger
def serve(request):
    raise ValueError("never")
def late(message):
    rospy.signal_shutdown("over")
    raise ValueError("too late")
rospy.init_node("brain")
service = rospy.Service("ask", Trigger, serve)
def ask():
    try:
        rospy.ServiceProxy("ask", Trigger)()
    except rospy.ServiceException as error:
        print(error)
ask()
sub = rospy.Subscriber("numbers", Int8, late)
threading.excepthook = lambda args: None
threading.Thread(target=lambda: 1 / 0).start()
rospy.spin()
"""
        told, finished = self.failures(text, numbers(1))
        self.assertEqual(told, [])
        self.assertIn("error processing request: never", finished.out)
        self.assertNotIn("too late", finished.err)

    def test_a_text_that_cannot_be_made_and_one_without_end(self):
        text = """
class Odd(Exception):
    def __str__(self):
        raise ValueError
def hear(message):
    raise Odd() if message.data else ValueError("x" * 9000)
rospy.init_node("brain")
import hrdsl.told as told
for value in (1, 0):
    try:
        hear(Int8(value))
    except Exception as error:
        told.failed("/brain", "hear", error)
"""
        told, _ = self.failures(text)
        self.assertEqual(told[0][2], "hear raised Odd: <its text cannot be made>")
        self.assertEqual(len(told[1][2]), 2000)


class Rclpy(unittest.TestCase):
    TEXT = """
import rclpy, threading, time
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int8
rclpy.init()
node = Node("brain", namespace="robot")
def hear(message):
    raise ValueError("number %d" % message.data)
async def later(message):
    raise ValueError("number %d" % message.data)
"""

    def ended(self, text, code):
        system = System(numbers(3), end=20 * SECOND)
        finished = run_ros2(self.TEXT + text, system=system)
        self.assertEqual(finished.code, code, finished.err)
        return finished, system.failures

    def test_what_leaves_spin_names_node_and_callback(self):
        line = "ValueError: number 3\nhrdsl: it was raised in a callback of the node /robot/brain: %s\n"
        topic = "subscriber of /numbers (std_msgs/msg/Int8)"
        for text, where in (
            ("node.create_subscription(Int8, '/numbers', hear, 1)\nrclpy.spin(node)", topic),
            ("node.create_subscription(Int8, '/numbers', later, 1)\nrclpy.spin(node)", topic),
            ("node.create_subscription(Int8, '/numbers', hear, 1)\ne = MultiThreadedExecutor()\ne.add_node(node)\ne.spin()", topic),
            ("node.create_timer(0.5, lambda: hear(Int8(data=3)))\nrclpy.spin(node)", "timer of 0.5 s"),
        ):
            finished, told = self.ended(text, 1)
            self.assertTrue(finished.err.endswith(line % where), finished.err)
            self.assertEqual(told, [])

    def test_what_ends_a_thread_that_spins_is_told(self):
        text = """
node.create_subscription(Int8, "/numbers", hear, 1)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
time.sleep(5)
print("goes on")
"""
        finished, told = self.ended(text, 0)
        where = "subscriber of /numbers (std_msgs/msg/Int8)"
        self.assertEqual(told, [(SECOND, "/robot/brain", where + " raised ValueError: number 3")])
        self.assertIn("ValueError: number 3\n", finished.err)
        self.assertEqual(finished.out, "goes on\n")

    def test_what_the_program_catches_is_told_when_it_goes_on(self):
        where = "subscriber of /numbers (std_msgs/msg/Int8) raised ValueError: number 3"
        begin = "node.create_subscription(Int8, '/numbers', hear, 1)\n"
        caught = begin + "try:\n    rclpy.spin(node)\nexcept Exception as error:\n    print('caught', error)\n%s"
        thread = "thread = threading.Thread(target=spin)\nthread.start()\nthread.join()"
        for text, time in (
            (caught % "", SECOND),
            (caught % "time.sleep(3)", SECOND),
            (caught % "    time.sleep(3)\ntime.sleep(2)\n", 4 * SECOND),  # only then it is clear that it is not raised again
            (begin + "def spin():\n    try:\n        rclpy.spin(node)\n    except ValueError as error:\n        print('caught', error)\n" + thread, SECOND),
            (begin + "while node.get_clock().now().nanoseconds < 1735689604 * 10**9:\n    try:\n        rclpy.spin_once(node, timeout_sec=1)\n"
                "    except Exception as error:\n        print('caught', error)\n", SECOND),
        ):  # fmt: skip
            with self.subTest(text):
                finished, told = self.ended(text, 0)
                self.assertEqual((finished.out, finished.err), ("caught number 3\n", ""))
                self.assertEqual(told, [(time, "/robot/brain", where)])

    def test_what_is_raised_again_or_is_no_error_is_not_told(self):
        begin = "node.create_subscription(Int8, '/numbers', hear, 1)\n"
        for text, code in (
            (begin + "try:\n    rclpy.spin(node)\nfinally:\n    time.sleep(1)\n    node.destroy_node()\n    rclpy.shutdown()", 1),
            (begin + "try:\n    rclpy.spin(node)\nexcept ValueError as error:\n    time.sleep(1)\n    raise RuntimeError('no') from error", 1),
            (begin + "try:\n    try:\n        rclpy.spin(node)\n    except ValueError:\n        time.sleep(1)\n        raise\nfinally:\n    time.sleep(1)", 1),
            ("def leave():\n    raise SystemExit\nnode.create_timer(1, leave)\ntry:\n    rclpy.spin(node)\nexcept SystemExit:\n    time.sleep(1)", 0),
            ("try:\n    rclpy.spin_until_future_complete(node, rclpy.task.Future(), timeout_sec=1)\n    raise ValueError\nexcept ValueError:\n    pass\ntime.sleep(1)", 0),
        ):  # fmt: skip
            with self.subTest(text):
                self.assertEqual(self.ended(text, code)[1], [])


if __name__ == "__main__":
    unittest.main()
