"""The classes of ROS 2's messages, as rosidl lays them out."""

import importlib.util
import unittest

from ros2_programs import Ros2Case

TRY = """
def tried(call):
    try:
        print(call())
    except Exception as error:
        print("%s: %s" % (type(error).__name__, str(error)[:120]))
"""


class Messages(Ros2Case):
    def test_fields(self):
        text = """
            from sensor_msgs.msg import JointState, LaserScan
            from std_msgs.msg import Header, String
            import std_msgs.msg
            m = JointState(name=["a", "b"], position=[1, 2.5])
            m.header.stamp.sec = 3
            print(m)
            print(m.position, m.position.typecode, m.name, JointState.get_fields_and_field_types()["position"])
            print(m == JointState(), m == JointState(header=m.header, name=["a", "b"], position=[1.0, 2.5]), m != 3)
            print(JointState.__slots__, LaserScan(), String)
            print(std_msgs.msg.String is String, String("x") if False else String(data="x"))
            import copy
            other = copy.deepcopy(m)
            other.header.frame_id = "map"
            print(m.header.frame_id == "", other.header.frame_id, hasattr(m, "SLOT_TYPES"))
            """
        self.assertEqual(
            self.said(text),
            [
                "sensor_msgs.msg.JointState(header=std_msgs.msg.Header(stamp=builtin_interfaces.msg.Time(sec=3, nanosec=0), "
                "frame_id=''), name=['a', 'b'], position=[1.0, 2.5], velocity=[], effort=[])",
                "array('d', [1.0, 2.5]) d ['a', 'b'] sequence<double>",
                "False True True",
                "['_header', '_name', '_position', '_velocity', '_effort'] sensor_msgs.msg.LaserScan(header=std_msgs.msg.Header("
                "stamp=builtin_interfaces.msg.Time(sec=0, nanosec=0), frame_id=''), angle_min=0.0, angle_max=0.0, "
                "angle_increment=0.0, time_increment=0.0, scan_time=0.0, range_min=0.0, range_max=0.0, ranges=[], intensities=[]) "
                "<class 'std_msgs.msg._string.String'>",
                "True std_msgs.msg.String(data='x')",
                "True map False",
            ],
        )

    def test_what_does_not_fit(self):
        text = TRY + """
from std_msgs.msg import Float64, Int8, String, Bool, Header, UInt8
from geometry_msgs.msg import Twist, Vector3
from sensor_msgs.msg import JointState
from odd_msgs.msg import Odd
tried(lambda: Float64(data=1))
tried(lambda: Int8(data=200))
tried(lambda: UInt8(data=-1))
tried(lambda: String(data=3))
tried(lambda: Bool(data=1))
tried(lambda: Float64(value=1.0, other=2))
tried(lambda: Float64(1.0))
tried(lambda: Twist(linear=3))
try:
    setattr(Float64(), "dat", 1.0)
except AttributeError as error:
    print(str(error)[:39])
tried(lambda: setattr(JointState(), "position", [1, 2]))
tried(lambda: setattr(JointState(), "position", "abc"))
tried(lambda: setattr(JointState(), "name", [1]))
tried(lambda: Odd(short="abcdef"))
tried(lambda: Odd(few=["a", "b", "c"]))
tried(lambda: Odd(flag=3))
tried(lambda: Odd(single=1e39))
tried(lambda: Odd(place=[1.0]))
tried(lambda: setattr(Odd(), "key", [1, 2, 3, 300]))
tried(lambda: setattr(Odd(), "headers", [1]))
tried(lambda: hash(String()))
"""
        self.assertEqual(
            self.said(text),
            [
                "AssertionError: The 'data' field must be of type 'float'",
                "AssertionError: The 'data' field must be an integer in [-128, 127]",
                "AssertionError: The 'data' field must be an unsigned integer in [0, 255]",
                "AssertionError: The 'data' field must be of type 'str'",
                "AssertionError: The 'data' field must be of type 'bool'",
                "AssertionError: Invalid arguments passed to constructor: other, value",
                "TypeError: Float64.__init__() takes 1 positional argument but 2 were given",
                "AssertionError: The 'linear' field must be a sub message of type 'Vector3'",
                "'Float64' object has no attribute 'dat'",
                "AssertionError: The 'position' field must be a set or sequence and each value of type 'float' and each double in "
                "[-179769313486231570814",
                "AssertionError: The 'position' field must be a set or sequence and each value of type 'float' and each double in "
                "[-179769313486231570814",
                "AssertionError: The 'name' field must be a set or sequence and each value of type 'str'",
                "AssertionError: The 'short' field must be string value not longer than 5",
                "AssertionError: The 'few' field must be a set or sequence with length <= 2 and each value of type 'str'",
                "AssertionError: The 'flag' field must be of type 'bytes' or 'ByteString' with length 1",
                "AssertionError: The 'single' field must be a float in [-3.402823466e+38, 3.402823466e+38]",
                "AssertionError: ",
                "AssertionError: The 'key' field must be a set or sequence with length 4 and each value of type 'int' and each "
                "unsigned integer in [0, 25",
                "AssertionError: The 'headers' field must be a set or sequence and each value of type 'Header'",
                "TypeError: unhashable type: 'String'",
            ],
        )

    def test_odd_ones(self):
        text = TRY + """
import sys
sys.modules["numpy"] = None  # as where it is not installed
from odd_msgs.msg import Odd, Nothing
m = Odd()
print(m)
print(Odd.LEFT, m.GREETING, Odd.SHORT__DEFAULT, Nothing(), Nothing() == Nothing())
print(Odd.get_fields_and_field_types())
m.key[0] = 9
print(Odd().key, list(m.key))
setattr(m, "from", "x")
print(getattr(m, "from"), Odd(**{"from": "y"})._from)
tried(lambda: m.place.reshape(3, 1))
tried(lambda: Odd.SLOT_TYPES)
from std_srvs.srv import SetBool
print(SetBool.Request(data=True), SetBool.Response(), SetBool)
tried(SetBool)
"""
        self.assertEqual(
            self.said(text),
            [
                "odd_msgs.msg.Odd(flag=b'\\x07', letter=0, truths=[], pair=[b'\\x00', b'\\x00'], short='abc', few=[], "
                "numbers=[1, -2], single=0.5, singles=[], place=[0.0, 0.0, 0.0], key=[0, 0, 0, 0], from='', headers=[], wide='')",
                "-1 hello abc odd_msgs.msg.Nothing() True",
                "{'flag': 'octet', 'letter': 'uint8', 'truths': 'sequence<boolean>', 'pair': 'octet[2]', 'short': 'string<5>', "
                "'few': 'sequence<string, 2>', 'numbers': 'sequence<int32>', 'single': 'float', 'singles': 'sequence<float>', "
                "'place': 'double[3]', 'key': 'uint8[4]', 'from': 'string', 'headers': 'sequence<std_msgs/Header>', "
                "'wide': 'wstring'}",
                "[0, 0, 0, 0] [9, 0, 0, 0]",
                "x y",
                "AttributeError: 'list' object has no attribute 'reshape': arrays of a fixed size are numpy arrays where numpy is "
                "installed, and lists wh",
                "AttributeError: SLOT_TYPES of Odd: use get_fields_and_field_types() instead",
                "std_srvs.srv.SetBool_Request(data=True) std_srvs.srv.SetBool_Response(success=False, message='') "
                "<class 'std_srvs.srv._set_bool.SetBool'>",
                "NotImplementedError: Service classes can not be instantiated",
            ],
        )

    @unittest.skipUnless(importlib.util.find_spec("numpy"), "NumPy is not installed")
    def test_arrays_of_a_fixed_size_are_those_of_numpy(self):
        text = TRY + """
import numpy
from odd_msgs.msg import Odd
m = Odd(key=numpy.array([1, 2, 3, 4], dtype=numpy.uint8))
m.place[1] = 0.5
print(type(m.key).__name__, m.key.dtype, m.key.tolist(), m.place.reshape(3, 1).tolist())
tried(lambda: setattr(m, "key", numpy.array([1, 2, 3, 4])))
tried(lambda: setattr(m, "place", numpy.zeros(2)))
"""
        self.assertEqual(
            self.said(text),
            [
                "ndarray uint8 [1, 2, 3, 4] [[0.0], [0.5], [0.0]]",
                "AssertionError: The 'key' numpy.ndarray() must have the dtype of 'numpy.uint8'",
                "AssertionError: The 'place' numpy.ndarray() must have a size of 3",
            ],
        )

    def test_the_wire(self):
        text = """
            import sys
            sys.modules["numpy"] = None  # as where it is not installed
            import rclpy, array
            from rclpy.node import Node
            from odd_msgs.msg import Odd
            from std_msgs.msg import Header
            rclpy.init()
            node = Node("n", start_parameter_services=False)
            node.create_subscription(Odd, "odd", lambda m: print(m, m.singles.typecode), 1)
            nan, inf = float("nan"), float("inf")
            node.create_publisher(Odd, "odd", 1).publish(Odd(
                truths=[True, False], singles=[0.1, nan, -inf], single=inf, place=[1.0, 0.1, nan], wide="\\u20ac\\n", letter=65,
                headers=[Header(frame_id="a")], **{"from": 'quo"ted'}))
            rclpy.spin_once(node)
            """
        self.assertEqual(
            self.said(text),
            [
                "odd_msgs.msg.Odd(flag=b'\\x07', letter=65, truths=[True, False], pair=[b'\\x00', b'\\x00'], short='abc', few=[], "
                "numbers=[1, -2], single=inf, singles=[0.10000000149011612, nan, -inf], place=[1.0, 0.1, nan], key=[0, 0, 0, 0], "
                "from='quo\"ted', headers=[std_msgs.msg.Header(stamp=builtin_interfaces.msg.Time(sec=0, nanosec=0), "
                "frame_id='a')], wide='€\\n') f",
            ],
        )
        sent = next(each["message"] for each in self.finished.requests if each["request"] == "publish")
        self.assertEqual(
            sent,
            {
                "flag": 7,
                "letter": 65,
                "truths": [True, False],
                "pair": [0, 0],
                "short": "abc",
                "few": [],
                "numbers": [1, -2],
                "single": "inf",
                "singles": [0.10000000149011612, "nan", "-inf"],
                "place": [1.0, 0.1, "nan"],
                "key": [0, 0, 0, 0],
                "from": 'quo"ted',
                "headers": [{"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "a"}],
                "wide": "€\n",
            },
        )


if __name__ == "__main__":
    unittest.main()
