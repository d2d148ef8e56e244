"""Transforms that a node tells itself, and what is said of those that are not there."""
import rospy
import tf
import tf2_ros
from geometry_msgs.msg import TransformStamped

rospy.init_node("transforms")
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
broadcaster = tf2_ros.StaticTransformBroadcaster()
message = TransformStamped()
message.header.stamp = rospy.Time.now()
message.header.frame_id, message.child_frame_id = "map", "base"
message.transform.translation.x, message.transform.rotation.w = 1.5, 1.0
broadcaster.sendTransform(message)
rospy.sleep(1.0)
found = buffer.lookup_transform("map", "base", rospy.Time(0))
print(found.header.frame_id, found.child_frame_id, found.transform.translation.x, found.transform.rotation.w)
print(buffer.lookup_transform("base", "map", rospy.Time()).transform.translation.x)
print(buffer.can_transform("map", "base", rospy.Time(0)), buffer.can_transform("map", "nowhere", rospy.Time(0)))
for kind, args in (("LookupException", ("map", "nowhere", rospy.Time(0))), ("LookupException", ("nowhere", "map", rospy.Time(0))), ("", ("", "map", rospy.Time(0)))):
    try:
        print(buffer.lookup_transform(*args))
    except Exception as error:
        print(type(error).__name__, error)
start = rospy.get_time()
print(buffer.can_transform("map", "nowhere", rospy.Time(0), rospy.Duration(0.5)), "%.1f s" % (rospy.get_time() - start))
old, sender = tf.TransformListener(), tf.TransformBroadcaster()
for _ in range(5):
    sender.sendTransform((0, 2, 0), (0, 0, 0, 1), rospy.Time.now(), "arm", "base")
    rospy.sleep(0.2)
print(old.lookupTransform("base", "arm", rospy.Time(0)), old.frameExists("arm"), old.frameExists("nowhere"), old.canTransform("base", "arm", rospy.Time(0)))
try:
    old.lookupTransform("base", "nowhere", rospy.Time(0))
except tf.LookupException as error:
    print(error)
try:
    old.waitForTransform("base", "nowhere", rospy.Time(0), rospy.Duration(0.3))
except tf.Exception as error:
    print(type(error).__name__, error)
print(tf.LookupException.__mro__[1].__name__, tf2_ros.LookupException.__mro__[1].__name__, tf.LookupException is tf2_ros.LookupException)
