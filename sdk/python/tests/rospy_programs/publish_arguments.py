"""What `publish` may be given, and what it says of all else, with a subscriber."""
import rospy
from geometry_msgs.msg import Point, PointStamped, Pose, Twist
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Bool, Empty, Float64, Header, Int8, String, UInt8

rospy.init_node("publish_arguments")


def call(kind, *args, **keys):
    return kind, args, keys


def hear(message):
    print("heard", type(message).__name__, str(message).split())


calls = [
    call(Int8, 1),
    call(Int8, data=2),
    call(Int8, Int8(3)),
    call(Int8),
    call(Int8, 1, 2),
    call(Int8, date=2),
    call(Int8, 1, data=2),
    call(Int8, 300),
    call(Int8, "five"),
    call(Int8, 1.5),
    call(Int8, None),
    call(Int8, True),
    call(Int8, String("x")),
    call(UInt8, -1),
    call(String, "word"),
    call(String, 5),
    call(String, None),
    call(String, b"bytes"),
    call(String, "\u00fc"),
    call(Empty),
    call(Empty, Empty()),
    call(Empty, 1),
    call(Point, 1, 2, 3),
    call(Point, x=1),
    call(Point, 1, 2),
    call(Point, 1),
    call(Point, x="1"),
    call(PointStamped, Header(), Point(1, 2, 3)),
    call(PointStamped, point=Point(1, 2, 3)),
    call(PointStamped, Point()),
    call(PointStamped, Header(), 5),
    call(Bool, True),
    call(Bool, 1),
    call(Bool, 2),
    call(Bool, "yes"),
    call(Float64, 2),
    call(Float64, "2"),
    call(Float64, [1]),
    call(Image, data="text"),
    call(Image, data=[1, 300]),
    call(Image, data=[1, 2]),
    call(Image, data=b"12"),
    call(Image, data=5),
    call(JointState, name="ab"),
    call(JointState, name=["a", 5]),
    call(JointState, name=["a", b"b"]),
    call(JointState, position=[1, 2]),
    call(JointState, position=["1"]),
    call(JointState, position=5),
    call(Twist, Pose()),
    call(Twist, 1, 2),
]
publishers, kept = [], []
for number, (kind, _, _) in enumerate(calls):
    publishers.append(rospy.Publisher("topic_%d" % number, kind, queue_size=10))
    kept.append(rospy.Subscriber("topic_%d" % number, kind, hear))
rospy.sleep(3)
for publisher, (kind, args, keys) in zip(publishers, calls):
    try:
        result = publisher.publish(*args, **keys)
    except Exception as error:
        result = "%s: %s" % (type(error).__name__, error)
    rospy.sleep(0.15)
    print(kind.__name__, args, keys, result)
