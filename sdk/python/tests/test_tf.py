"""`tf`, `tf2_ros` and `tf2_geometry_msgs`: what is published of frames, and where they were to each other."""

import math
import unittest

from system import System
from tables import run_ros

SECOND = 10**9
START = 1735689600  # of simulated time, since 1970

IMPORTS = """
import math, sys
import rospy, tf, tf2_ros
from geometry_msgs.msg import PointStamped, PoseStamped, QuaternionStamped, TransformStamped, Vector3Stamped
START = 1735689600

def near(numbers):
    return [round(number, 6) + 0.0 for number in numbers]

def at(seconds):
    return rospy.Time.from_sec(START + seconds)

def turned(angle):
    return 0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)

def say(*what):
    print("%.3f" % (rospy.get_time() - START), *what)

"""


def transform(parent, child, seconds, x, y=0.0, yaw=0.0):
    return {
        "header": {"seq": 0, "stamp": {"secs": START + int(seconds), "nsecs": round(seconds % 1 * 1e9)}, "frame_id": parent},
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x, "y": y, "z": 0.0},
            "rotation": {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)},
        },
    }


def heard(seconds, *transforms, topic="/tf"):
    return round(seconds * SECOND), {"topic": topic, "message": {"transforms": list(transforms)}}


class Case(unittest.TestCase):
    def said(self, text, system=None):
        done = run_ros(IMPORTS + text, ["geometry_msgs", "tf2_msgs", "std_msgs", "sensor_msgs"], system)
        self.assertEqual(done.code, 0, done.err)
        self.err, self.requests = done.err, done.requests
        return done.out.splitlines()


class Listeners(Case):
    def test_a_place_between_two_that_were_heard(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
rospy.sleep(3)
for seconds in (1, 1.5, 2):
    place, rotation = listener.lookupTransform("/map", "base", at(seconds))
    print(near(place), near([tf.transformations.euler_from_quaternion(rotation)[2]]))
print(near(listener.lookupTransform("base", "map", rospy.Time(0))[0]), type(place), type(rotation))
print(near(listener.lookupTransform("tool", "map", rospy.Time())[0]), near(listener.lookupTransform("map", "tool", rospy.Time())[0]))
print(listener.frameExists("base"), listener.frameExists("map"), sorted(listener.getFrameStrings()))
print(listener.canTransform("map", "base", at(1.2)), listener.canTransform("map", "base", at(2.1)))
print(listener.getLatestCommonTime("map", "tool") == at(2), listener.allFramesAsString().splitlines()[0])
"""
        arrivals = [
            heard(1, transform("map", "base", 1, 1.0, 0.0, 0.0), transform("base", "tool", 1, 0.5)),
            heard(2, transform("/map", "/base", 2, 2.0, 4.0, 1.0)),
            heard(2.5, transform("base", "tool", 2.5, 0.5)),
        ]
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "[1.0, 0.0, 0.0] [0.0]",
                "[1.5, 2.0, 0.0] [0.5]",
                "[2.0, 4.0, 0.0] [1.0]",
                str([round(-2 * math.cos(1) - 4 * math.sin(1), 6), round(2 * math.sin(1) - 4 * math.cos(1), 6), 0.0])
                + " <class 'list'> <class 'list'>",
                str([round(-2 * math.cos(1) - 4 * math.sin(1) - 0.5, 6), round(2 * math.sin(1) - 4 * math.cos(1), 6), 0.0])
                + " "
                + str([round(2 + 0.5 * math.cos(1), 6), round(4 + 0.5 * math.sin(1), 6), 0.0]),
                "True False ['base', 'tool']",
                "1 0",
                "True Frame base exists with parent map.",
            ],
        )

    def test_between_two_times(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
begun = rospy.get_time()
listener.waitForTransformFull("base", at(2), "base", at(1), "map", rospy.Duration(4))
print(rospy.get_time() - begun)
place, rotation = listener.lookupTransformFull("base", at(2), "base", at(1), "map")
print(near(place), near(tf.transformations.euler_from_quaternion(rotation)), type(place), type(rotation))
print(near(listener.lookupTransformFull("base", at(1), "/base", at(2), "/map")[0]))
print(listener.canTransformFull("base", at(2), "base", at(1), "map"), listener.canTransformFull("base", at(3), "base", at(1), "map"))
for call, *more in (listener.lookupTransformFull,), (listener.waitForTransformFull, rospy.Duration(0.5)):
    begun = rospy.get_time()
    try:
        call("base", at(9), "base", at(1), "map", *more)
    except tf.Exception as error:
        print(rospy.get_time() - begun, "base" in str(error) and "into the future" in str(error))
"""
        arrivals = [heard(1, transform("map", "base", 1, 1.0)), heard(2, transform("map", "base", 2, 3.0, 1.0))]
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "2.0",
                "[-2.0, -1.0, 0.0] [0.0, 0.0, 0.0] <class 'list'> <class 'list'>",
                "[2.0, 1.0, 0.0]",
                "1 0",
                "0.0 True",
                "0.5 True",
            ],
        )

    def test_what_is_not_known(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
rospy.sleep(3)
for target, source, seconds in (("map", "moon", 0), ("map", "other", 0), ("map", "base", 0.5), ("map", "base", 2.5), ("map", "tool", 7)):
    try:
        listener.lookupTransform(target, source, at(seconds) if seconds else rospy.Time(0))
    except (tf.LookupException, tf.ConnectivityException, tf.ExtrapolationException) as error:
        print(type(error).__name__, error, isinstance(error, tf.Exception))
"""
        arrivals = [
            heard(1, transform("map", "base", 1, 1.0), transform("base", "tool", 1, 1.0)),
            heard(2, transform("map", "base", 2, 2.0), transform("island", "other", 2, 0.0)),
        ]
        out = self.said(text, System(arrivals))
        self.assertEqual(out[0], 'LookupException "moon" passed to lookupTransform argument source_frame does not exist.  True')
        self.assertEqual(
            out[1],
            "ConnectivityException Could not find a connection between 'map' and 'other' because they are not part of the same"
            " tree.Tf has two or more unconnected trees. True",
        )
        asked = "Requested time %.9f but the %s data is at time %.9f, when looking up transform from frame [base] to frame [map]"
        past = "Lookup would require extrapolation 0.500000000s into the past.  "
        future = "Lookup would require extrapolation 0.500000000s into the future.  "
        self.assertEqual(out[2], "ExtrapolationException %s%s True" % (past, asked % (START + 0.5, "earliest", START + 1)))
        self.assertEqual(out[3], "ExtrapolationException %s%s True" % (future, asked % (START + 2.5, "latest", START + 2)))
        self.assertIn("extrapolation at time %.9f, but only time %.9f is" % (START + 7, START + 1), out[4])

    def test_waiting_for_a_frame(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
listener.waitForTransform("map", "base", rospy.Time(0), rospy.Duration(4))
say(near(listener.lookupTransform("map", "base", rospy.Time(0))[0]))
try:
    listener.waitForTransform("map", "moon", rospy.Time(0), rospy.Duration(2))
except tf.Exception as error:
    say(error)
while not listener.canTransform("map", "base", at(3.55)):
    pass
print(3.6 <= rospy.get_time() - START < 3.61)
"""
        arrivals = [heard(1.5, transform("map", "base", 1.5, 1.0)), heard(3.6, transform("map", "base", 3.6, 2.0))]
        out = self.said(text, System(arrivals))
        self.assertEqual(out, ["1.500 [1.0, 0.0, 0.0]", "3.500 canTransform: source_frame moon does not exist.", "True"])

    def test_messages_in_other_frames(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
rospy.sleep(2)
def stamped(kind):
    made = kind()
    made.header.frame_id = "base"
    made.header.stamp = at(1)
    return made
point, vector, rotation, pose = map(stamped, (PointStamped, Vector3Stamped, QuaternionStamped, PoseStamped))
point.point.x = vector.vector.x = pose.pose.position.x = 1.0
rotation.quaternion.w = pose.pose.orientation.w = 1.0
found = listener.transformPoint("map", point)
print(found.header.frame_id, found.header.stamp == at(1), near((found.point.x, found.point.y)))
found = listener.transformVector3("map", vector).vector
print(near((found.x, found.y)))
found = listener.transformQuaternion("map", rotation).quaternion
print(near((found.z, found.w)))
found = listener.transformPose("map", pose).pose
print(near((found.position.x, found.position.y, found.orientation.z)))

import tf2_geometry_msgs
buffer = listener._buffer
print(buffer.transform(pose, "map").pose == found, tf2_ros.convert(pose, PoseStamped) == pose)
print(near([buffer.transform(point, "map", rospy.Duration(1)).point.y]))
way = buffer.lookup_transform("map", "base", at(1))
print(tf2_geometry_msgs.do_transform_pose(pose, way).pose == found, near([tf2_geometry_msgs.do_transform_point(point, way).point.y]))
try:
    buffer.transform(rotation, "map")
except tf2_ros.TypeException as error:
    print(str(error)[-60:])
"""
        arrivals = [heard(1, transform("map", "base", 1, 2.0, 3.0, math.pi / 2))]
        half = round(math.sqrt(0.5), 6)
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "map True [2.0, 4.0]",
                "[0.0, 1.0]",
                "[%s, %s]" % (half, half),
                "[2.0, 4.0, %s]" % half,
                "True True",
                "[4.0]",
                "True [4.0]",
                "ed (for messages of geometry_msgs, import tf2_geometry_msgs)",
            ],
        )

    def test_static_frames_and_other_times(self):
        text = """
rospy.init_node("listener")
buffer = tf2_ros.Buffer(rospy.Duration(5))
tf2_ros.TransformListener(buffer)
rospy.sleep(9)
print(near([buffer.lookup_transform("map", "camera", at(7)).transform.translation.x]))
print(buffer.lookup_transform("base", "camera", rospy.Time(0)).header.stamp.to_nsec())
found = buffer.lookup_transform_full("base", at(6), "base", at(8), "map")
print(near([found.transform.translation.x]), found.header.frame_id, found.child_frame_id, found.header.stamp == at(6))
print(buffer.can_transform("map", "base", at(2)), buffer.can_transform("map", "base", at(3)))
print(buffer.can_transform_full("base", at(6), "base", at(8), "map"), buffer.can_transform("map", "map", at(99)))
try:
    buffer.lookup_transform("/map", "base", rospy.Time(0))
except tf2_ros.InvalidArgumentException as error:
    print(error)
"""
        arrivals = [heard(n, transform("map", "base", n, float(n))) for n in range(1, 9)]
        arrivals += [heard(1, transform("base", "camera", 0, 0.25), topic="/tf_static")]
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "[7.25]",
                "0",
                "[2.0] base base True",
                "0 1",
                "1 1",
                "Invalid argument \"/map\" passed to lookupTransform argument target_frame in tf2 frame_ids cannot start with a '/' like: ",
            ],
        )

    def test_how_fast_a_frame_moves_and_what_lies_between(self):
        text = """
rospy.init_node("listener")
listener = tf.TransformListener()
rospy.sleep(6)
for part in listener.lookupTwist("base", "map", rospy.Time(0), rospy.Duration(2)):
    print(near(part))
print(listener.chain("map", rospy.Time(0), "tool", rospy.Time(0), "base"), listener.chain("tool", rospy.Time(0), "eye", rospy.Time(0), "base"))
print(listener.chain("tool", rospy.Time(0), "eye", rospy.Time(0), "map"))
"""
        arrivals = [heard(n, transform("map", "base", n, 0.5 * n, 0.0, 0.0)) for n in range(1, 6)]
        arrivals += [heard(1, transform("base", "tool", 0, 1.0), transform("base", "eye", 0, 1.0), topic="/tf_static")]
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "[0.5, 0.0, 0.0]",
                "[0.0, 0.0, 0.0]",
                "['tool', 'base', 'map'] ['eye', 'base', 'tool']",
                "['eye', 'base', 'map', 'base', 'tool']",
            ],
        )

    def test_what_is_wrong_with_a_transform(self):
        text = """
rospy.init_node("listener")
transformer = tf.Transformer()
def put(parent, child, seconds=1, w=1.0, x=0.0):
    made = TransformStamped()
    made.header.frame_id, made.child_frame_id, made.header.stamp = parent, child, at(seconds)
    made.transform.rotation.w, made.transform.translation.x = w, x
    transformer.setTransform(made)
put("a", "a")
put("a", "")
put("", "a")
put("a", "b", w=0.5)
put("a", "b", x=float("nan"))
put("a", "b", 20)
put("a", "b", 20)
put("a", "b", 9)
put("b", "a", 20)
try:
    transformer.lookupTransform("a", "c", rospy.Time(0))
except tf.LookupException as error:
    print(error)
put("c", "d")
try:
    transformer.lookupTransform("d", "a", at(20))
except tf.LookupException as error:
    print(str(error).splitlines()[0])
try:
    transformer.waitForTransform("a", "c", rospy.Time(0), rospy.Duration(1))
except tf.Exception as error:
    print(error)
"""
        out = self.said(text)
        self.assertEqual(
            out,
            [
                '"c" passed to lookupTransform argument source_frame does not exist. ',
                "The tf tree is invalid because it contains a loop.",
                "cannot wait for transform without a dedicated thread that listens to incoming TF messages",
            ],
        )
        kinds = [line.split(":")[1].split()[0] for line in self.err.splitlines()]
        self.assertEqual(
            kinds,
            [
                "TF_SELF_TRANSFORM",
                "TF_NO_CHILD_FRAME_ID",
                "TF_NO_FRAME_ID",
                "TF_DENORMALIZED_QUATERNION",
                "TF_NAN_INPUT",
                "TF_REPEATED_DATA",
                "TF_OLD_DATA",
            ],
        )


class Refusals(Case):
    def test_what_is_not_there(self):
        text = """
import tf_conversions
rospy.init_node("listener")
print(tf_conversions.transformations is tf.transformations)
transformer = tf.Transformer()
for wrong in (
    lambda: tf2_ros.BufferClient("server"),
    lambda: tf_conversions.fromMsg(None),
):
    try:
        wrong()
    except NotImplementedError as error:
        print(str(error).partition(":")[0])
"""
        self.assertEqual(
            self.said(text),
            [
                "True",
                "tf2_ros.BufferClient, which asks a server of transforms, is not there in hrdsl",
                "tf_conversions.fromMsg, which needs PyKDL, is not there in hrdsl",
            ],
        )


class Broadcasters(Case):
    def test_they_publish(self):
        text = """
rospy.init_node("broadcaster")
broadcaster = tf.TransformBroadcaster()
listener = tf.TransformListener()
broadcaster.sendTransform((1, 2, 3), turned(1.0), rospy.Time.now(), "base", "map")
static = tf2_ros.StaticTransformBroadcaster()
fixed = TransformStamped()
fixed.header.frame_id, fixed.child_frame_id = "base", "camera"
fixed.transform.rotation.w = 1.0
static.sendTransform(fixed)
rospy.sleep(1)
print(near(listener.lookupTransform("map", "camera", rospy.Time(0))[0]))
"""
        system = System()
        self.assertEqual(self.said(text, system), ["[1.0, 2.0, 3.0]"])
        (at, name, message), (_, other, _) = system.published
        sent = message["transforms"][0]
        self.assertEqual((at, name, other), (0, "/tf", "/tf_static"))
        self.assertEqual((sent["header"]["frame_id"], sent["child_frame_id"]), ("map", "base"))
        self.assertEqual(sent["transform"]["translation"], {"x": 1.0, "y": 2.0, "z": 3.0})
        self.assertEqual(sent["header"]["stamp"], {"secs": START, "nsecs": 0})
        opened = {port["name"]: port for port in self.requests if port.get("kind") == "publisher"}
        self.assertTrue(opened["/tf_static"]["latched"])
        self.assertEqual(opened["/tf"]["type"], "tf2_msgs/TFMessage")


if __name__ == "__main__":
    unittest.main()
