"""What messages are made of: constructors, defaults, equality, and wrong values."""
# departs: `_full_text` of the standard packages has no comments, and says `std_msgs/Header` for `Header`
import copy
import pickle

import genpy
import rospy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, PoseWithCovariance
from sensor_msgs.msg import CameraInfo, Image, JointState, LaserScan, NavSatStatus, Range
from std_msgs.msg import Bool, Empty, Float64, Header, Int32, String, UInt8MultiArray, Int16MultiArray
from std_srvs.srv import SetBool, SetBoolRequest, Trigger


def tried(text):
    try:
        print(text, "=", " | ".join(repr(eval(text)).splitlines()))
    except Exception as error:
        print(text, "!", type(error).__name__, " | ".join(str(error).splitlines()))


for text in (
    "String().data", "Point(1, 2, 3)", "Point(x=1)", "Point(1, 2)", "Point(1)", "Point(w=1)", "Point(1, 2, 3, x=1)", "Point(None, None, 1)",
    "Point('a', [], {})", "Empty(1)", "Empty(x=1)", "Empty() == Empty()", "Bool().data", "Int32().data", "Int32(data=None).data", "Int32(None).data",
    "Int32(1, 2)", "Pose().orientation", "Pose(Point(1, 2, 3), None).orientation.w", "Image().data", "Image().encoding", "JointState().name",
    "JointState().position", "LaserScan().ranges", "PoseWithCovariance().covariance", "CameraInfo().K", "CameraInfo().D", "CameraInfo().roi.do_rectify",
    "UInt8MultiArray().data", "Int16MultiArray().data", "Header().stamp", "Header().frame_id", "type(Header().stamp)", "Header().seq",
    "Point(1, 2, 3) == Point(1.0, 2.0, 3.0)", "Point() != Point()", "Point() == Quaternion()", "Point() == 5", "Point() == None",
    "JointState(name=['a']) == JointState(name=('a',))", "Header() == Header()", "Pose() == Pose()", "hash(Point())", "Point() < Point()",
    "Point.__slots__", "Point._slot_types", "PoseStamped._slot_types", "Point._type", "Point._md5sum", "PoseStamped._md5sum", "Point._has_header",
    "PoseStamped._has_header", "JointState._has_header", "Header._has_header", "SetBoolRequest._type", "Trigger._type", "Trigger._md5sum",
    "Trigger._request_class.__slots__", "SetBool._response_class._slot_types", "NavSatStatus.STATUS_FIX", "NavSatStatus.STATUS_NO_FIX",
    "NavSatStatus().STATUS_NO_FIX", "Range.ULTRASOUND", "Point.__module__", "SetBoolRequest.__module__", "SetBool.__module__", "Point.__name__",
    "isinstance(Point(), genpy.Message)", "isinstance(Point(), rospy.Message)", "issubclass(SetBool, genpy.Message)", "Point().__getstate__()",
    "copy.deepcopy(Pose(Point(1, 2, 3), Quaternion())).position.z", "pickle.loads(pickle.dumps(Header(1, rospy.Time(2), 'x'))).frame_id",
    "Point(1, 2, 3)._get_types()", "Point()._check_types()", "Point('x', 0, 0)._check_types()", "Pose(Point(), Point())._check_types()",
    "Header('x', 0, 0)._check_types()", "Header(1, 0, 'x')._check_types()", "Bool(5)._check_types()", "String(5)._check_types()",
    "String('\u00fc')._check_types()", "JointState(name=[1])._check_types()", "JointState(name='abc')._check_types()",
    "JointState(position=['x'])._check_types()", "Image(data='text')._check_types()", "Image(data=[1, 300])._check_types()",
    "PoseWithCovariance(covariance=[1])._check_types()", "Int32(2**31)._check_types()", "Int32(1.0)._check_types()", "Int32(True)._check_types()",
    "UInt8MultiArray(data=5)._check_types()", "PoseStamped(header=Point())._check_types()", "genpy.message.get_message_class('std_msgs/String') is String",
    "genpy.message.get_service_class('std_srvs/SetBool') is SetBool", "genpy.message.get_message_class('Header') is Header", "Point().foo",
):  # fmt: skip
    tried(text)
point = Point()
try:
    point.foo = 5
    print("set")
except AttributeError as error:
    print(str(error).split(" and ")[0])  # of which newer versions of Python say more
print(PoseStamped._full_text)
print(Trigger._response_class._full_text)
