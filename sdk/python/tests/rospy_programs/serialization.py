"""Messages as bytes, and what is no message."""
import io

import genpy
import rospy
from geometry_msgs.msg import Point, PoseStamped
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import Bool, Empty, Float32, Float64, Header, Int8, Int64, String, Time, UInt8, UInt8MultiArray
from geometry_msgs.msg import PoseWithCovariance


def written(message):
    buffer = io.BytesIO()
    try:
        message.serialize(buffer)
        data = buffer.getvalue()
        print(type(message).__name__, data.hex() if len(data) < 100 else "%d bytes" % len(data))
        return data
    except Exception as error:
        print(type(message).__name__, type(error).__name__, " | ".join(str(error).splitlines()))


for message in (
    String("word"), String("\u00fc"), String(b"\xff\x00"), Bool(True), Int8(-1), UInt8(200), Int64(-5), Float32(0.1), Float64(0.1), Empty(), Point(1, 2, 3),
    Header(1, rospy.Time(2, 3), "map"), Time(rospy.Time(5, 6)), Image(data=b"\x01\x02"), Image(data=[1, 2]), JointState(name=["a", "bc"], position=[1.0]),
    LaserScan(ranges=[1.0, 2.0]), UInt8MultiArray(data=bytearray(b"xy")), PoseWithCovariance(), String(5), String(None), Int8(200), Int8("x"), Int8(1.5),
    UInt8(-1), Float64("x"), Float64(None), Bool("x"), Point(1, 2, "x"), JointState(position=["x"]), JointState(name=[5]), JointState(position=5),
    PoseWithCovariance(covariance=[1.0]), Header(-1, rospy.Time(), ""), Header(0, 5, ""), Image(data=[300]), Image(data="text"),
    PoseStamped(pose=Point()), PoseStamped(header=None), Int8(True), Bool(7),
):  # fmt: skip
    written(message)
again = JointState().deserialize(written(JointState(Header(1, rospy.Time(2, 3), "f"), ["a", "b"], [1, 2], [], [0.5])))
print(repr(again.name), repr(again.position), repr(again.velocity), repr(again.effort), repr(again.header.stamp), type(again.header.stamp).__module__)
image = Image().deserialize(written(Image(data=[1, 2, 3], encoding="rgb8", is_bigendian=1)))
print(repr(image.data), repr(image.encoding), repr(image.is_bigendian))
print(repr(Bool().deserialize(b"\x05").data), repr(String().deserialize(b"\x01\x00\x00\x00\xfc").data), repr(Float32().deserialize(b"\x00\x00\x80\x3f").data))
print(repr(PoseWithCovariance().deserialize(written(PoseWithCovariance())).covariance)[:20])
for kind, data in ((Point, b"123"), (String, b"\x05\x00\x00\x00a"), (String, b""), (Bool, b""), (JointState, b"\x00"), (Empty, b"x"), (Int8, b"\x01\x02"),
                   (Point, None), (Point, "text")):  # fmt: skip
    try:
        print(kind.__name__, repr(kind().deserialize(data)).split())
    except Exception as error:
        print(kind.__name__, type(error).__name__, error)
print(genpy.SerializationError.__mro__[1:3], genpy.DeserializationError.__mro__[1:3])
