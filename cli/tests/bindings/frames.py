"""Looks up where declared bodies are, by both listeners, and passes on a frame of its own that moves with one of them."""

import rospy
import tf
import tf2_ros
from geometry_msgs.msg import TransformStamped


def rounded(*values):
    return " ".join("%.2f" % (value + 0.0) for value in values)


def since_start(stamp):
    return "%.2f" % (stamp.to_sec() - 1735689600)


rospy.init_node("brain")
listener = tf.TransformListener()
buffer = tf2_ros.Buffer()
tf2_ros.TransformListener(buffer)

listener.waitForTransform("table", "mug", rospy.Time(0), rospy.Duration(1))
place, turn = listener.lookupTransform("table", "mug", rospy.Time(0))
print("the mug from the table:", rounded(*place), "turned", rounded(*turn))
print("as it was at", since_start(listener.getLatestCommonTime("table", "mug")))

handle = TransformStamped()
handle.header.frame_id, handle.child_frame_id = "mug", "handle"
handle.transform.translation.x = 0.05
handle.transform.rotation.w = 1.0
tf2_ros.StaticTransformBroadcaster().sendTransform(handle)

rospy.sleep(rospy.Time(1735689602.5) - rospy.Time.now())
for when in (rospy.Time(1735689601.0), rospy.Time(1735689601.5), rospy.Time(0)):
    found = buffer.lookup_transform("world", "handle", when, rospy.Duration(1))
    at = found.transform.translation
    print("the handle at", since_start(found.header.stamp), "is at", rounded(at.x, at.y, at.z))
try:
    buffer.lookup_transform("world", "moon", rospy.Time(0))
except tf2_ros.LookupException as error:
    print(str(error).strip())
