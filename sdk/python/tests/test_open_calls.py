"""What a program says of services that have not answered when the test ends."""

import unittest

from ros2_programs import run_ros2
from system import System
from tables import run_ros

SECOND = 10**9

ROS1 = """
    import threading
    import rospy
    from std_srvs.srv import Trigger
    rospy.init_node("node")
    lock = threading.Lock()
    def serve(request):
        with lock:
            return True, ""
    service = rospy.Service("grip", Trigger, serve)
    rospy.wait_for_service("grip")
    grip = rospy.ServiceProxy("grip", Trigger)
    """


class OpenCalls(unittest.TestCase):
    def said(self, finished):
        self.assertEqual(finished.code, 0, finished.err)
        return finished.err.splitlines()

    def ended(self, text):
        return self.said(run_ros(ROS1 + text, ["std_srvs"], system=System(end=20 * SECOND)))

    def test_a_program_that_waits_for_itself(self):
        said = self.ended("""
    rospy.sleep(1)
    with lock:
        grip()
    """)
        self.assertEqual(len(said), 2, said)
        self.assertIn("hrdsl: at the end the client of /grip (std_srvs/Trigger) has no answer to its call of 1.000 s, in ServiceProxy.__call__ at ", said[0])
        self.assertEqual(said[1], "hrdsl: nor has this program answered a call of /grip (std_srvs/Trigger) of 1.000 s: programs that wait for each other never go on")

    def test_nothing_is_said_of_calls_that_were_answered(self):
        self.assertEqual(self.ended("""
    for _ in range(3):
        grip()
        rospy.sleep(1)
    rospy.spin()
    """), [])

    def test_a_callback_of_ros_2_that_calls_a_service_of_its_own_executor(self):
        text = """
import rclpy
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node("brain")
def serve(request, response):
    return response
node.create_service(Trigger, "/grip", serve)
client = node.create_client(Trigger, "/grip")
node.create_timer(1.0, lambda: client.call(Trigger.Request()))
rclpy.spin(node)
"""
        said = self.said(run_ros2(text, system=System(end=20 * SECOND)))
        self.assertEqual(len(said), 2, said)
        self.assertIn("the client of /grip (std_srvs/srv/Trigger) has no answer to its call of 1.000 s, in Client.call at ", said[0])
        self.assertIn("nor has this program answered a call of /grip (std_srvs/srv/Trigger) of 1.000 s", said[1])


if __name__ == "__main__":
    unittest.main()
