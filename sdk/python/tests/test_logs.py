"""What programs log is told to the harness besides, with its level, by all three loggers."""

import unittest

from harness import run_text
from ros2_programs import run_ros2
from system import System
from tables import run_ros

SECOND = 10**9


class Logs(unittest.TestCase):
    def logged(self, run, text, **how):
        system = System(end=20 * SECOND)
        self.finished = run(text, system=system, **how)
        self.assertEqual(self.finished.code, 0, self.finished.err)
        return [(time / SECOND, *more) for time, *more in system.logged]

    def test_of_rospy(self):
        text = """
            import logging, rospy
            rospy.logwarn("before the node")
            rospy.init_node("brain")
            rospy.logdebug("left out")
            rospy.loginfo("%d per cent \\u00fc", 5)
            rospy.sleep(1.5)
            rospy.logwarn_once("low")
            rospy.logerr("x" * 5000)
            rospy.logfatal("gone \\ud800")
            logging.getLogger("rosout.arm").warning("by logging")
            def over():
                rospy.logwarn("the end")
            rospy.on_shutdown(over)
            rospy.spin()
            """
        logged = self.logged(run_ros, text)
        self.assertEqual(logged, [
            (0.0, "info", "/brain", "5 per cent \u00fc"),
            (1.5, "warn", "/brain", "low"),
            (1.5, "error", "/brain", "x" * 2000),
            (1.5, "fatal", "/brain", "gone ?"),
            (1.5, "warn", "/brain", "by logging"),
        ])  # fmt: skip
        for text in ("before the node\n", "the end\n", "x" * 5000 + "\n"):
            self.assertIn(text, self.finished.err)
        self.assertIn("[INFO] [1735689600.000000]: 5 per cent \u00fc\n", self.finished.out)

    def test_of_rclpy(self):
        text = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("brain")
node.get_logger().debug("left out")
node.get_logger().info("ready")
arm = node.get_logger().get_child("arm")
rclpy.spin_once(node, timeout_sec=0.5)
for _ in range(3):
    arm.error("stuck", once=True)
node.get_logger().fatal("gone")
node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1))
"""
        self.assertEqual(self.logged(run_ros2, text), [
            (0.0, "info", "brain", "ready"),
            (0.5, "error", "brain.arm", "stuck"),
            (0.5, "fatal", "brain", "gone"),
        ])  # fmt: skip
        self.assertIn("[brain.arm]: stuck\n", self.finished.err)

    def test_of_the_sdk(self):
        text = """
            import hrdsl
            log = hrdsl.Logger("robot", level="debug")
            log.info("before the node")
            node = hrdsl.Node("robot")
            log.debug("%s of %d", "one", 2)
            node.sleep(1.25)
            log.warn("100 %")
            log.error("wrong"); log.fatal("gone")
            hrdsl.Logger("quiet", level="fatal").error("left out")
            try:
                hrdsl.Logger("robot", level="loud")
            except ValueError as error:
                print(error)
            """
        self.assertEqual(self.logged(run_text, text), [
            (0.0, "debug", "robot", "one of 2"),
            (1.25, "warn", "robot", "100 %"),
            (1.25, "error", "robot", "wrong"),
            (1.25, "fatal", "robot", "gone"),
        ])  # fmt: skip
        self.assertEqual(self.finished.err.splitlines()[:3], [
            "[INFO] [0.000] [robot]: before the node", "[DEBUG] [0.000] [robot]: one of 2", "[WARN] [1.250] [robot]: 100 %",
        ])  # fmt: skip
        self.assertEqual(self.finished.out, "no level 'loud'; there are debug, info, warn, error, fatal\n")


if __name__ == "__main__":
    unittest.main()
