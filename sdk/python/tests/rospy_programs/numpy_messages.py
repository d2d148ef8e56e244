"""Messages with arrays of NumPy."""
# needs: numpy
import numpy
import rospy
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import Float32, Float64MultiArray, Int32

rospy.init_node("numpy_messages")


def hear(message):
    for name in ("ranges", "data", "position"):
        if hasattr(message, name):
            value = getattr(message, name)
            print("heard", name, type(value).__name__, getattr(value, "dtype", None), numpy.ravel(value if not isinstance(value, bytes) else list(value)).tolist())


def tried(kind, message):
    publisher = rospy.Publisher("topic_%d" % len(kept), kind, queue_size=1)
    kept.append((publisher, rospy.Subscriber("topic_%d" % len(kept), kind, hear)))
    rospy.sleep(0.7)
    try:
        publisher.publish(message)
    except Exception as error:
        print(type(error).__name__, str(error).splitlines()[0])
    rospy.sleep(0.3)


kept = []
tried(numpy_msg(LaserScan), LaserScan(ranges=numpy.array([1.5, 2.5], dtype=numpy.float32)))
tried(LaserScan, LaserScan(ranges=numpy.array([1.5, 2.5])))
tried(LaserScan, LaserScan(ranges=numpy.array([1, 2])))
tried(JointState, JointState(position=numpy.zeros(2)))
tried(JointState, JointState(position=numpy.zeros((2, 2))))
tried(Image, Image(data=numpy.array([1, 2], dtype=numpy.uint8).tobytes()))
tried(Image, Image(data=numpy.array([1, 2], dtype=numpy.uint8).tolist()))
tried(Float64MultiArray, Float64MultiArray(data=numpy.arange(3.0)))
tried(Int32, numpy.int32(5))
tried(Int32, Int32(numpy.int64(6)))
tried(Float32, numpy.float32(1.5))
tried(Float32, numpy.float64(1.5))
print(str(Float64MultiArray(data=numpy.arange(3.0))).splitlines()[-1], Int32(numpy.int32(5)), Float32(numpy.float32(1.5)))
