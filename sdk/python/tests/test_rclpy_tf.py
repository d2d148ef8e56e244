"""`tf2_ros` and `tf2_geometry_msgs` of ROS 2: what is published of frames, and where they were to each other."""

import math
import unittest

from ros2_programs import SECOND, Ros2Case
from system import System

START = 1735689600  # of simulated time, since 1970

IMPORTS = """
import math, sys, threading
import rclpy, tf2_ros, tf2_geometry_msgs
from geometry_msgs.msg import *
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Header
START = 1735689600

def at(seconds):
    return Time(seconds=START + seconds)

def place(found):
    moved, turned = found.transform.translation, found.transform.rotation
    yaw = 2 * math.atan2(turned.z, turned.w)
    return [round(number, 6) + 0.0 for number in (moved.x, moved.y, yaw)]

def transform(parent, child, seconds, x, yaw=0.0):
    made = TransformStamped(child_frame_id=child)
    made.header = Header(frame_id=parent, stamp=at(seconds).to_msg())
    made.transform.translation.x = x
    made.transform.rotation = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return made

def say(*what):
    print("%.2f" % (node.get_clock().now().nanoseconds / 1e9 - START), *what)

def run(seconds):
    end = node.create_timer(seconds, lambda: None)
    before = node.get_clock().now()
    while node.get_clock().now() - before < Duration(seconds=seconds):
        rclpy.spin_once(node)
    end.destroy()

rclpy.init()
node = Node("node")
"""


def transform(parent, child, seconds, x, yaw=0.0):
    return {
        "header": {"stamp": {"sec": START + int(seconds), "nanosec": round(seconds % 1 * 1e9)}, "frame_id": parent},
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x, "y": 0.0, "z": 0.0},
            "rotation": {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)},
        },
    }


def heard(seconds, *transforms, topic="/tf"):
    return round(seconds * SECOND), {"topic": topic, "message": {"transforms": list(transforms)}}


class Listeners(Ros2Case):
    def test_places_that_were_heard(self):
        text = """
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer, node)
run(3.0)
say(place(buffer.lookup_transform("map", "base", at(1.5))))
say(place(buffer.lookup_transform("map", "base", at(1.5).to_msg())))
found = buffer.lookup_transform("base", "map", Time())
say(place(found), found.header.frame_id, found.child_frame_id, found.header.stamp.sec - START)
say(place(buffer.lookup_transform("map", "laser", Time())))
say(place(buffer.lookup_transform_full("base", at(2), "base", at(1), "map")))
say(buffer.can_transform("map", "base", at(9)), buffer.can_transform("map", "no", Time(), return_debug_tuple=True))
say(buffer.can_transform_full("base", at(2), "base", at(1), "map"))
for frames, time in (("map", "no"), Time()), (("map", "/base"), Time()), (("map", "base"), at(0)), (("map", "moon"), Time()):
    try:
        buffer.lookup_transform(*frames, time)
    except tf2_ros.TransformException as error:
        say(type(error).__name__)
try:
    buffer.lookup_transform("map", "base", 1.5)
except TypeError as error:
    say(error)
listener.unregister()
"""
        arrivals = [
            heard(0.5, transform("base", "laser", 0, 0.25), topic="/tf_static"),
            heard(1, transform("map", "base", 1, 1.0)),
            heard(2, transform("map", "base", 2, 3.0, math.pi / 2)),
            heard(2, transform("sky", "moon", 2, 3.0)),
        ]
        system = System(arrivals, end=9 * SECOND)
        out = [
            "3.00 [2.0, 0.0, 0.785398]",
            "3.00 [2.0, 0.0, 0.785398]",
            "3.00 [0.0, 3.0, -1.570796] base map 2",
            "3.00 [3.0, 0.25, 1.570796]",
            "3.00 [0.0, 2.0, -1.570796]",
            "3.00 False (False, 'canTransform: source_frame no does not exist.')",
            "3.00 True",
            "3.00 LookupException",
            "3.00 InvalidArgumentException",
            "3.00 ExtrapolationException",
            "3.00 ConnectivityException",
            "3.00 time must have sec and nanosec, or nanoseconds.",
        ]
        wrong = 'Warning: Invalid argument "/base" passed to canTransform argument source_frame in tf2 frame_ids cannot start '
        self.assertEqual(self.said(IMPORTS + text, system, err=wrong + "with a '/' like: \n"), out)

    def test_who_waits_keeps_its_thread(self):
        text = """
buffer = tf2_ros.Buffer(Duration(seconds=5))
listener = tf2_ros.TransformListener(buffer, node)
try:
    buffer.lookup_transform("map", "base", Time(), Duration(seconds=2))
except tf2_ros.LookupException as error:
    say(error)
run(0.1)
say(place(buffer.lookup_transform("map", "base", Time(), Duration(seconds=2))))
"""
        system = System([heard(1, transform("map", "base", 1, 1.0))], end=9 * SECOND)
        out = ['2.00 "map" passed to lookupTransform argument target_frame does not exist. ', "2.10 [1.0, 0.0, 0.0]"]
        self.assertEqual(self.said(IMPORTS + text, system), out)

    def test_a_thread_of_its_own(self):
        text = """
buffer = tf2_ros.Buffer(node=node)
listener = tf2_ros.TransformListener(buffer, node, spin_thread=True)
say(place(buffer.lookup_transform("map", "base", Time(), Duration(seconds=2))))
say(buffer.can_transform("map", "base", at(3), Duration(seconds=0.5)))
rclpy.shutdown()
listener.dedicated_listener_thread.join()
"""
        system = System([heard(1, transform("map", "base", 1, 1.0))], end=9 * SECOND)
        self.assertEqual(self.said(IMPORTS + text, system), ["1.02 [1.0, 0.0, 0.0]", "1.52 False"])

    def test_who_awaits(self):
        text = """
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer, node)

async def look():
    say(place(await buffer.lookup_transform_async("map", "base", at(2))))
    say(place(await buffer.wait_for_transform_async("map", "base", Time())))
    say(place(await buffer.lookup_transform_full_async("base", at(2), "base", at(1), "map")))
    say(buffer._waiting)

task = rclpy.get_global_executor().create_task(look)
rclpy.spin_until_future_complete(node, task)
print(task.exception())
"""
        moves = [heard(second, transform("map", "base", second, float(second))) for second in (1, 2, 3)]
        out = ["2.00 [2.0, 0.0, 0.0]", "2.00 [2.0, 0.0, 0.0]", "2.00 [-1.0, 0.0, 0.0]", "2.00 []", "None"]
        self.assertEqual(self.said(IMPORTS + text, System(moves, end=9 * SECOND)), out)


class Broadcasters(Ros2Case):
    def test_what_they_publish(self):
        text = """
moving = tf2_ros.TransformBroadcaster(node)
static = tf2_ros.StaticTransformBroadcaster(node)
static.sendTransform([transform("base", "laser", 0, 0.25), transform("base", "eye", 0, 0.5)])
moving.sendTransform(transform("map", "base", 0, 1.0))
buffer = tf2_ros.Buffer(node=node)
listener = tf2_ros.TransformListener(buffer, node)
moving.sendTransform((transform("map", "base", 1, 2.0),))
run(0.5)
say(place(buffer.lookup_transform("map", "laser", Time())), place(buffer.lookup_transform("map", "eye", Time())))
from tf2_msgs.srv import FrameGraph
future = node.create_client(FrameGraph, "tf2_frames").call_async(FrameGraph.Request())
rclpy.spin_until_future_complete(node, future)
print(*future.result().frame_yaml.splitlines()[:2])
"""
        out = ["0.50 [2.25, 0.0, 0.0] [2.5, 0.0, 0.0]", "base:    parent: 'map'"]
        self.assertEqual(self.said(IMPORTS + text), out)

    def test_what_is_refused(self):
        text = """
try:
    tf2_ros.BufferClient(node, "server")
except NotImplementedError as error:
    print(error)
"""
        out = [
            "tf2_ros.BufferClient is not supported by hrdsl's rclpy: make a tf2_ros.Buffer and a tf2_ros.TransformListener instead"
        ]
        self.assertEqual(self.said(IMPORTS + text), out)


class Messages(Ros2Case):
    def test_as_seen_from_another_frame(self):
        text = """
buffer = tf2_ros.Buffer()
buffer.set_transform(transform("map", "base", 1, 1.0, math.pi / 2), "test")
header = Header(frame_id="base", stamp=at(1).to_msg())

def near(*numbers):
    return [float(round(number, 6)) + 0.0 for number in numbers]  # perhaps numpy's

point = buffer.transform(PointStamped(header=header, point=Point(x=2.0)), "map")
print(point.header.frame_id, near(point.point.x, point.point.y))
vector = buffer.transform(Vector3Stamped(header=header, vector=Vector3(x=2.0)), "map")
print(near(vector.vector.x, vector.vector.y))
pose = buffer.transform(PoseStamped(header=header, pose=Pose(position=Point(x=2.0))), "map")
print(type(pose).__name__, near(pose.pose.position.y, pose.pose.orientation.z, pose.pose.orientation.w))
print(tf2_ros.convert(pose, PoseStamped) == pose)
found = buffer.lookup_transform("map", "base", Time())
import tf2_geometry_msgs as of
print(near(of.do_transform_pose(Pose(position=Point(y=1.0)), found).position.x))
print(near(of.do_transform_pose_stamped(PoseStamped(pose=Pose(position=Point(y=1.0))), found).pose.position.x))
print(near(of.do_transform_point(PointStamped(point=Point(y=1.0)), found).point.x))
print(near(of.do_transform_vector3(Vector3Stamped(vector=Vector3(y=1.0)), found).vector.x))
unsure = PoseWithCovarianceStamped(header=header)
unsure.pose.covariance = [float(number) for number in range(36)]
print(near(*buffer.transform(unsure, "map").pose.covariance[:12]))
wrench = buffer.transform(WrenchStamped(header=header, wrench=Wrench(torque=Vector3(x=3.0))), "map")
print(near(wrench.wrench.torque.x, wrench.wrench.torque.y))
polygon = PolygonStamped(header=header, polygon=Polygon(points=[Point32(x=1.0), Point32(y=1.0)]))
print([near(point.x, point.y) for point in buffer.transform(polygon, "map").polygon.points])
full = buffer.transform_full(PointStamped(header=header, point=Point(x=2.0)), "map", Time(), "map")
print(near(full.point.y))
try:
    buffer.transform(TwistStamped(header=header), "map")
except tf2_ros.TypeException as error:
    print(error.errstr[:29])
print(tf2_ros.Stamped(PointStamped(), at(1).to_msg(), "base").header == header)
"""
        out = [
            "map [1.0, 2.0]",
            "[0.0, 2.0]",
            "PoseStamped [2.0, 0.707107, 0.707107]",
            "True",
            "[0.0]",
            "[0.0]",
            "[0.0]",
            "[-1.0]",
            "[7.0, -6.0, -8.0, 10.0, -9.0, -11.0, -1.0, 0.0, 2.0, -4.0, 3.0, 5.0]",
            "[0.0, 3.0]",
            "[[1.0, 1.0], [0.0, 0.0]]",
            "[2.0]",
            "Type <class 'geometry_msgs.ms",
            "True",
        ]
        self.assertEqual(self.said(IMPORTS + text), out)


if __name__ == "__main__":
    unittest.main()
