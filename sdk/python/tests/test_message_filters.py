"""Filters of messages, under both clients: the same messages, and what comes of them."""

import unittest

from ros2_programs import run_ros2
from system import System
from tables import run_ros

MILLI = 10**6

#: Stamps in milliseconds of what two topics publish, in the order in which it comes.
COMES = [("/a", 10), ("/b", 40), ("/a", 40), ("/b", 57), ("/a", 60), ("/b", 58), ("/a", 90), ("/b", 10)]

SAYS = """
def ms(stamp):
    seconds, nanoseconds = (stamp.secs, stamp.nsecs) if hasattr(stamp, "secs") else (stamp.sec, stamp.nanosec)
    return seconds * 1000 + nanoseconds // 1000000
def both(name):
    return lambda *messages: print(name, *[ms(m.header.stamp) for m in messages])
a, b = subscriber("a"), subscriber("b")
exact = mf.TimeSynchronizer([a, b], 10)
exact.registerCallback(both("exact"))
short = mf.TimeSynchronizer([a, b], 1)
short.registerCallback(both("short"))
near = mf.ApproximateTimeSynchronizer([a, b], 10, 0.005)
near.registerCallback(both("near"))
cache = mf.Cache(a, 2)
cache.registerCallback(lambda message, word: print(word, ms(message.header.stamp)), "cached")
print(a.getTopic(), cache.getLast(), cache.getOldestTime())
"""

ROS1 = """
import rospy
import message_filters as mf
from std_msgs.msg import Bool
from geometry_msgs.msg import PointStamped
rospy.init_node("node")
def subscriber(name):
    return mf.Subscriber(name, PointStamped, queue_size=5)
%s
odd = mf.Cache(mf.Subscriber("odd", Bool))
odd.registerCallback(lambda message: print("odd", message.data))
free = mf.Cache(mf.Subscriber("odd", Bool), 1, allow_headerless=True)
free.registerCallback(lambda message: print("free", message.data, free.getLastestTime().to_sec()))
rospy.sleep(1)
T = lambda ms: rospy.Time(0, ms * 1000000)
print([ms(m.header.stamp) for m in cache.getInterval(T(60), T(90))], cache.getInterval(T(61), T(89)))
print(ms(cache.getElemAfterTime(T(61)).header.stamp), cache.getElemAfterTime(T(91)))
print(ms(cache.getElemBeforeTime(T(89)).header.stamp), cache.getElemBeforeTime(T(59)))
print(ms(cache.getLast().header.stamp), cache.getOldestTime().to_sec(), cache.getLastestTime().to_sec())
print(a.sub.name, a.get_num_connections())
"""

ROS2 = """
import rclpy
import message_filters as mf
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from std_msgs.msg import Bool
from geometry_msgs.msg import PointStamped
rclpy.init()
node = rclpy.create_node("node")
def subscriber(name):
    return mf.Subscriber(node, PointStamped, name, qos_profile=qos_profile_sensor_data)
%s
odd = mf.Cache(mf.Subscriber(node, Bool, "odd"))
odd.registerCallback(lambda message: print("odd", message.data))
free = mf.Cache(mf.Subscriber(node, Bool, "odd", 1), 1, allow_headerless=True)
free.registerCallback(lambda message: print("free", message.data, free.getLatestTime().nanoseconds / 1e9))
node.create_timer(1.0, rclpy.shutdown)
try:
    rclpy.spin(node)
except rclpy.executors.ExternalShutdownException:
    pass
T = lambda ms: Time(nanoseconds=ms * 1000000)
print([ms(m.header.stamp) for m in cache.getInterval(T(60), T(90))], cache.getInterval(T(61), T(89)))
print(ms(cache.getElemAfterTime(T(61)).header.stamp), cache.getElemAfterTime(T(91)))
print(ms(cache.getElemBeforeTime(T(89)).header.stamp), cache.getElemBeforeTime(T(59)))
print(ms(cache.getLast().header.stamp), cache.getOldestTime().nanoseconds / 1e9, cache.getLatestTime().nanoseconds / 1e9)
print(a.sub.topic, a.get_publisher_count())
"""

OUT = [
    "%s None None",
    "cached 10",
    "exact 40 40",
    "short 40 40",
    "near 40 40",
    "cached 40",
    "near 60 57",
    "cached 60",
    "cached 90",
    "exact 10 10",
    "near 10 10",
    "free True 1735689600.5",
    "[60, 90] []",
    "90 None",
    "60 None",
    "90 0.06 0.09",
]

WARNING = (
    "Cannot use message filters with non-stamped messages. Use the 'allow_headerless' constructor option to auto-assign ROS time"
    " to headerless messages."
)


def comes(seconds, nanoseconds):
    point = {"x": 0, "y": 0, "z": 0}
    found = []
    for place, (name, stamp) in enumerate(COMES):
        header = {"stamp": {seconds: 0, nanoseconds: stamp * MILLI}, "frame_id": ""}
        if seconds == "secs":
            header["seq"] = 0
        found.append((place * 10 * MILLI + 1, {"topic": name, "message": {"header": header, "point": point}}))
    return found + [(500 * MILLI, {"topic": "/odd", "message": {"data": True}})]


class Filters(unittest.TestCase):
    maxDiff = None

    def test_of_ros1(self):
        packages = ("std_msgs", "geometry_msgs")
        finished = run_ros(ROS1 % SAYS, packages=packages, system=System(comes("secs", "nsecs")))
        self.assertEqual(finished.out.splitlines(), [line.replace("%s", "a") for line in OUT] + ["/a 0"])
        self.assertEqual((finished.code, finished.err), (0, "[WARN] [1735689600.500000]: %s\n" % WARNING))

    def test_of_ros2(self):
        finished = run_ros2(ROS2 % SAYS, system=System(comes("sec", "nanosec")))
        self.assertEqual(finished.out.splitlines(), [line.replace("%s", "a") for line in OUT] + ["a 0"])
        self.assertEqual((finished.code, finished.err), (0, "[WARN] [1735689600.500000000] [message_filters]: %s\n" % WARNING))


if __name__ == "__main__":
    unittest.main()
