"""How messages are printed."""
import genpy
import rospy
from geometry_msgs.msg import Pose, PoseArray, PoseStamped, TransformStamped
from nav_msgs.msg import OccupancyGrid, Path
from sensor_msgs.msg import Image, Imu, JointState, LaserScan
from std_msgs.msg import (
    Bool, ByteMultiArray, Char, ColorRGBA, Duration, Empty, Float32, Float64, Header, Int8, MultiArrayDimension, MultiArrayLayout,
    String, Time, UInt8MultiArray,
)  # fmt: skip
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

texts = ("", "plain", "two words", "quo'te", 'quo"te', "back\\slash", "line\nline", "tab\t", "\u00fc", "7", "true", "~", ": ", " blank ", "\x07",
         "a: b", "# no", "- x", "{}", "\u20ac\U0001f600", "a text of many words " * 7, "'words' " * 15, "line\n" * 20, "\u00fcber " * 20,
         "nospaces" * 15, "n", "y", "0x1F", "1e3", "1.5", "2001-01-01", "a,b", "[x]", "12:30", "=", "..x", "%", "a#b", "\x7f")  # fmt: skip
for message in [String(text) for text in texts] + [
    Bool(True), Int8(-5), Float64(1.5), Float64(1e300), Float64(float("nan")), Float64(2), Float32(0.1), Char(65), Empty(),
    Time(rospy.Time(1, 500)), Duration(rospy.Duration(-1.5)), ColorRGBA(1, 0.5, 0, 1), Header(3, rospy.Time(5, 6), "map"),
    Pose(), PoseStamped(), TransformStamped(child_frame_id="b"), PoseArray(poses=[Pose(), Pose()]), PoseArray(), Path(),
    JointState(name=list(texts)), JointState(name=["a", 5, None, True]),
    JointState(name=["a", "b c", "7", "", "x: y", "true", "it's", "\u00fc", "- d"], position=[1, 2.5], velocity=(3.0,), effort=[]),
    LaserScan(ranges=[1.0, float("inf")], angle_max=3.14159), Image(data=b"\x01\x02\xff", encoding="rgb8", height=1),
    Image(data=[1, 2]), UInt8MultiArray(data=b"ab"), UInt8MultiArray(data=[1, 2]), ByteMultiArray(data=[1, -2]),
    MultiArrayLayout(dim=[MultiArrayDimension("x", 2, 3)], data_offset=1), OccupancyGrid(data=[0, 100, -1]), Imu(),
    JointTrajectory(joint_names=["j"], points=[JointTrajectoryPoint(positions=[1], time_from_start=rospy.Duration(2))]),
]:  # fmt: skip
    print("== %s" % type(message).__name__)
    print(message)
    print(repr(message) == str(message), "%s" % message == str(message))
print(String(data=5), Float64("text"), Pose(position=None).position.x, String(b"bytes"))
print([Int8(1), String("x")], {"a": Bool(False)}, (Header(),))
for value in (1, 2.5, True, "text", [], [1, 2], ["a"], rospy.Time(1), rospy.Duration(1), None, b"x", [Pose()], [[1, 2]], (), [rospy.Time(1)], [True]):
    print(repr(value), "|", genpy.message.strify_message(value), "|", genpy.message.strify_message(value, "  "))
