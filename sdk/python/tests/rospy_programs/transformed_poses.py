"""`tf2_geometry_msgs`: points and poses in another frame."""
# departs: the text of a `TypeException` names the module to import
import rospy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped, Vector3Stamped

rospy.init_node("transformed_poses")
transform = TransformStamped()
transform.header.frame_id, transform.child_frame_id = "map", "base"
transform.header.stamp = rospy.Time(7)
transform.transform.translation.x, transform.transform.translation.y = 1.0, 2.0
transform.transform.rotation.z = transform.transform.rotation.w = 0.5**0.5


def near(place):
    return [round(getattr(place, name), 6) + 0.0 for name in ("x", "y", "z", "w") if hasattr(place, name)]


point = PointStamped()
point.header.frame_id, point.header.stamp, point.point.x = "base", rospy.Time(3), 1.0
found = tf2_geometry_msgs.do_transform_point(point, transform)
print(type(found).__name__, found.header.frame_id, found.header.stamp.to_sec(), near(found.point))
pose = PoseStamped()
pose.header.frame_id, pose.pose.position.x, pose.pose.orientation.w = "base", 1.0, 1.0
found = tf2_geometry_msgs.do_transform_pose(pose, transform)
print(type(found).__name__, found.header.frame_id, near(found.pose.position), near(found.pose.orientation))
vector = Vector3Stamped()
vector.header.frame_id, vector.vector.x = "base", 1.0
found = tf2_geometry_msgs.do_transform_vector3(vector, transform)
print(type(found).__name__, found.header.frame_id, near(found.vector))
buffer = tf2_ros.Buffer()
buffer.set_transform_static(transform, "here")
point.header.stamp = rospy.Time(0)
print(near(buffer.transform(point, "map").point), near(buffer.transform(pose, "map", rospy.Duration(0.1)).pose.position))
print(near(buffer.transform_full(point, "map", rospy.Time(0), "map").point))
for message, frame in ((point, "nowhere"), (transform, "map"), (5, "map")):
    try:
        print(buffer.transform(message, frame))
    except Exception as error:
        print(type(error).__name__, str(error).splitlines()[0][:60])
