"""What messages with arrays of NumPy take in the place of these, and hand over."""
# needs: numpy
import io

import numpy
import rospy
from geometry_msgs.msg import PoseWithCovariance, PoseWithCovarianceStamped
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import CameraInfo, ChannelFloat32, Image, LaserScan, MultiEchoLaserScan, LaserEcho, PointCloud
from std_msgs.msg import Float64MultiArray, Int8MultiArray, UInt8MultiArray

rospy.init_node("numpy_lists")
kept = []


def tried(kind, message, look, other=None):
    def hear(heard):
        value = look(heard)
        told = list(value) if isinstance(value, bytes) else numpy.ravel(value).tolist()[:5]
        print("heard", type(heard).__name__, type(value).__name__, getattr(value, "dtype", None), hasattr(value, "flags") and value.flags.writeable, told)

    name = "topic_%d" % len(kept)
    publisher = rospy.Publisher(name, kind, queue_size=1)
    kept.append((publisher, rospy.Subscriber(name, other or kind, hear)))
    rospy.sleep(0.7)
    print(name)
    try:
        publisher.publish(message)
    except Exception as error:
        print(type(error).__name__, str(error).splitlines()[0])
    rospy.sleep(0.3)


def single(*values):
    return numpy.array(values, dtype=numpy.float32)


Scan, Doubles, Channel = numpy_msg(LaserScan), numpy_msg(Float64MultiArray), numpy_msg(ChannelFloat32)
Pose, Cloud, Echoes = numpy_msg(PoseWithCovarianceStamped), numpy_msg(PointCloud), numpy_msg(MultiEchoLaserScan)

# The class of the message decides how it is sent, that of the publisher does not.
tried(Scan, LaserScan(ranges=[1.5, 2.5]), lambda m: m.ranges)
tried(Scan, Scan(ranges=[1.5, 2.5]), lambda m: m.ranges)
tried(Scan, Scan(ranges=single(1.5, 2.5)), lambda m: m.ranges)
tried(Scan, Scan(ranges=single(1.5, 2.5), intensities=single()), lambda m: m.ranges)
tried(LaserScan, LaserScan(ranges=[1.5]), lambda m: m.ranges, Scan)
tried(ChannelFloat32, Channel("a", single(1.5)), lambda m: m.values)
tried(ChannelFloat32, Channel("a", [1.5]), lambda m: m.values)
# Bytes in memory are sent, whatever they stand for.
tried(Doubles, Doubles(data=numpy.array([[1.5, 2.5], [3.0, 4.0]])), lambda m: m.data)
tried(Doubles, Doubles(data=numpy.array([1, 2])), lambda m: m.data)
tried(Doubles, Doubles(), lambda m: m.data)
tried(Channel, Channel("abcdefgh", numpy.array([1.5, 2.5])), lambda m: m.values)
tried(Channel, Channel("a", numpy.array(1.5, numpy.float32)), lambda m: m.values)
tried(Channel, Channel("a", None), lambda m: m.values)
tried(Channel, Channel("a", numpy.array([1.5], ">f4")), lambda m: m.values)
# Arrays of bytes are bytes.
tried(numpy_msg(Int8MultiArray), Int8MultiArray(data=numpy.array([1, -2], numpy.int8)), lambda m: m.data)
tried(numpy_msg(UInt8MultiArray), UInt8MultiArray(data=[1, 2]), lambda m: m.data)
tried(numpy_msg(UInt8MultiArray), numpy_msg(UInt8MultiArray)(data=numpy.array([1, 2], numpy.uint8)), lambda m: m.data)
tried(UInt8MultiArray, UInt8MultiArray(data=numpy.array([1, 2], numpy.uint8)), lambda m: m.data)
tried(Image, Image(data=range(3)), lambda m: m.data)
tried(Image, Image(data=bytearray(b"ab")), lambda m: m.data)
# So are the arrays of messages within.
tried(Pose, Pose(), lambda m: m.pose.covariance)
tried(Pose, Pose(pose=PoseWithCovariance(covariance=numpy.zeros((6, 6)))), lambda m: m.pose.covariance)
tried(Pose, PoseWithCovarianceStamped(), lambda m: m.pose.covariance)
tried(Cloud, Cloud(channels=[ChannelFloat32("a", single(1.5))]), lambda m: m.channels[0].values)
tried(Cloud, Cloud(channels=[ChannelFloat32("a", [1.5])]), lambda m: m.channels[0].values)
tried(Echoes, MultiEchoLaserScan(ranges=[LaserEcho([1.5])]), lambda m: m.ranges[0].echoes)
tried(numpy_msg(CameraInfo), CameraInfo(), lambda m: m.K)

message = Doubles(data=numpy.array([1.0]))
file = io.BytesIO()
message.serialize(file)
print(file.getvalue(), Doubles().deserialize(file.getvalue()).data, Float64MultiArray().deserialize(file.getvalue()).data)
print(Scan.__name__, numpy_msg(LaserScan) is Scan, issubclass(Scan, LaserScan), repr(message).splitlines()[-1])
