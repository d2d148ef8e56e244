"""Messages and times of ROS 1."""

import io
import json
import math
import pickle
import sys
import unittest

import tables

from hrdsl import interfaces  # noqa: E402

PACKAGES = ["std_msgs", "geometry_msgs", "sensor_msgs", "std_srvs", "trajectory_msgs", "play_motion_msgs", "rosgraph_msgs"]
ODD = "bool[] bits\nstring[2] names\ntime[] stamps\nint32 LOW=-5\nstring TEXT=a # b\nfloat32 HALF=0.5\nuint8[4] four\nfloat32 single\n"


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        interfaces._interfaces = interfaces.Interfaces(tables.table(PACKAGES, odd_msgs__Odd=ODD))
        interfaces.install()

    @classmethod
    def tearDownClass(cls):
        interfaces._interfaces = None
        for name in [name for name in sys.modules if "_msgs" in name or "_srvs" in name]:
            del sys.modules[name]

    def there_and_back(self, message):
        return type(message)._of_json(json.loads(message._json(message)))


class Messages(Case):
    def test_sums_are_those_of_ros(self):
        from geometry_msgs.msg import Twist
        from sensor_msgs.msg import JointState, LaserScan
        from std_msgs.msg import Float64, Header
        from std_srvs.srv import SetBool

        found = [each._md5sum for each in (Float64, Header, Twist, LaserScan, JointState, SetBool)]
        self.assertEqual(
            found,
            [
                "fdb28210bfa9d7c91146260178d9a584", "2176decaecbce78abc3b96ef049fabed", "9f195f881246fdfa2798d1d3eebca84a",
                "90c7ef2dc6895d81024acba2ac42f369", "3066dcd76a6cfaef579bd0f34173e9fd", "09fb03525b03e7ea1fd3992bafd87e16",
            ],
        )  # fmt: skip

    def test_constructors(self):
        from geometry_msgs.msg import Twist, Vector3
        from std_msgs.msg import Empty, Int8

        twist = Twist(Vector3(1, 2, 3), None)
        self.assertEqual((twist.linear.y, twist.angular), (2, Vector3()))
        self.assertEqual(Twist(angular=Vector3(z=1)).angular.z, 1)
        self.assertIsNot(Twist().linear, Twist().linear)
        for make, error, text in (
            (lambda: Int8(1, 2), TypeError, "Invalid number of arguments, args should be ['data'] args are(1, 2)"),
            (lambda: Int8(1, data=2), TypeError, "Message constructor may only use args OR keywords, not both"),
            (lambda: Int8(date=2), AttributeError, "date is not an attribute of Int8"),
            (lambda: Empty(1), TypeError, "Invalid number of arguments, args should be [] args are(1,)"),
        ):
            with self.assertRaises(error) as caught:
                make()
            self.assertEqual(str(caught.exception), text)

    def test_what_a_class_tells(self):
        from odd_msgs.msg import Odd
        from sensor_msgs.msg import LaserScan
        from std_msgs.msg import String

        self.assertEqual((Odd.LOW, Odd.TEXT, Odd.HALF), (-5, "a # b", 0.5))
        self.assertEqual(Odd.__slots__, ["bits", "names", "stamps", "four", "single"])
        self.assertEqual(Odd._slot_types, ["bool[]", "string[2]", "time[]", "uint8[4]", "float32"])
        self.assertEqual((Odd().names, Odd().four, Odd().bits), (["", ""], b"\0\0\0\0", []))
        self.assertEqual((LaserScan._has_header, String._has_header), (True, False))
        self.assertEqual((String._type, String._full_text, String.__module__), ("std_msgs/String", "string data\n", "std_msgs.msg._String"))
        self.assertIn("\n" + "=" * 80 + "\nMSG: std_msgs/Header\nuint32 seq\n", LaserScan._full_text)

    def test_there_and_back(self):
        import genpy
        from odd_msgs.msg import Odd
        from sensor_msgs.msg import LaserScan
        from std_msgs.msg import Header

        odd = Odd([True, 0], ["a", "ä\n"], [genpy.Time(1, 5)], b"\1\2\3\4", 0.1)
        same = self.there_and_back(odd)
        self.assertEqual((same.bits, same.names, same.stamps, same.four), ([True, False], ["a", "ä\n"], [genpy.Time(1, 5)], b"\1\2\3\4"))
        self.assertEqual(same.single, 0.10000000149011612)
        scan = LaserScan(header=Header(7, genpy.Time(3, 4), "base"), ranges=[1, math.inf, -math.inf, 0.1])
        same = self.there_and_back(scan)
        self.assertEqual(same.ranges, (1.0, math.inf, -math.inf, 0.10000000149011612))
        self.assertEqual(same.header, scan.header)
        self.assertTrue(math.isnan(self.there_and_back(LaserScan(angle_min=math.nan)).angle_min))
        for message in (odd, scan):
            file = io.BytesIO()
            message.serialize(file)
            again = type(message)().deserialize(file.getvalue())
            self.assertEqual(again, self.there_and_back(message))
            self.assertEqual(pickle.loads(pickle.dumps(again)), again)

    def test_what_does_not_fit_is_told_by_its_field(self):
        from genpy import SerializationError
        from geometry_msgs.msg import PoseStamped, Twist
        from sensor_msgs.msg import JointState
        from std_msgs.msg import Bool, Float64, Int8, String, UInt8

        for message, text in (
            (Int8(200), "field data exceeds specified width [int8]"),
            (Int8(1.5), "field data must be an integer type"),
            (UInt8(-1), "field data must be unsigned integer type"),
            (Float64("x"), "field data must be float type"),
            (Bool("x"), "field data is not a bool"),
            (String(5), "field data must be of type bytes or an ascii string"),
            (JointState(position=["a"]), "field position[] must be float type"),
            (JointState(name="ab", position=[1], velocity=5), "field name must be a list or tuple type. Only uint8[] can be a string"),
        ):
            with self.assertRaises(SerializationError) as caught:
                message._json(message)
            self.assertEqual(str(caught.exception), text)
        for message in (Twist((1, 2, 3), None), PoseStamped(header=5)):
            with self.assertRaises(AttributeError):
                message._json(message)

    def test_what_is_no_message_of_the_type(self):
        from genpy import DeserializationError
        from geometry_msgs.msg import Twist
        from std_msgs.msg import Float64

        with self.assertRaisesRegex(DeserializationError, "no std_msgs/Float64: there is no field 'data'"):
            Float64._of_json({})
        with self.assertRaisesRegex(DeserializationError, "no geometry_msgs/Vector3: there is no field 'z'"):
            Twist._of_json({"linear": {"x": 1, "y": 2}, "angular": {}})

    def test_as_text(self):
        from geometry_msgs.msg import Pose2D, PoseStamped
        from sensor_msgs.msg import Image, JointState
        from std_msgs.msg import String
        from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

        self.assertEqual(str(Pose2D(1, 2.5, 0)), "x: 1\ny: 2.5\ntheta: 0")
        self.assertEqual(repr(String('say "a"\n')), 'data: "say \\"a\\"\\n"')
        self.assertIn("header: \n  seq: 0\n  stamp: \n    secs: 0\n    nsecs:         0\n  frame_id: ''\npose: \n", str(PoseStamped()))
        self.assertIn("name: \n  - arm 1\n  - 'yes'\nposition: [1.0, 2.0]", str(JointState(name=["arm 1", "yes"], position=(1.0, 2.0))))
        self.assertIn("data: [1, 255]", str(Image(data=b"\1\xff")))
        text = str(JointTrajectory(points=[JointTrajectoryPoint(positions=[1.0])]))
        self.assertIn("points: \n  - \n    positions: [1.0]\n    velocities: []", text)

    def test_names_of_modules(self):
        import genpy.message
        import std_msgs.msg
        from play_motion_msgs.msg import PlayMotionAction, PlayMotionGoal
        from std_msgs.msg._String import String
        from std_srvs.srv._SetBool import SetBool, SetBoolRequest

        self.assertIs(String, std_msgs.msg.String)
        self.assertIs(SetBool._request_class, SetBoolRequest)
        self.assertEqual(PlayMotionAction().action_goal.goal, PlayMotionGoal())
        self.assertIn("Float64", dir(std_msgs.msg))
        self.assertIs(genpy.message.get_message_class("std_msgs/String"), String)
        self.assertIs(genpy.message.get_service_class("std_srvs/SetBool"), SetBool)
        self.assertIsNone(genpy.message.get_message_class("std_msgs/Strong"))
        with self.assertRaises(ImportError):
            from std_msgs.msg import Strong  # noqa: F401
        with self.assertRaises(ImportError):
            import std_msgs.srv  # noqa: F401
        space = {}
        exec("from std_msgs.msg import *", space)
        self.assertIs(space["String"], String)


class Times(unittest.TestCase):
    def test_arithmetic(self):
        from genpy import Duration, Time

        self.assertEqual((Time(1, 1500000000).secs, Time(1, 1500000000).nsecs), (2, 500000000))
        self.assertEqual(Time(5) - Time(3, 1), Duration(1, 999999999))
        self.assertEqual(Time(5) + Duration(0.5), Time(5, 500000000))
        self.assertEqual(Duration(0, -1), Duration(-1, 999999999))
        self.assertEqual((-Duration(1.5)).to_sec(), -1.5)
        self.assertEqual((Duration(3) / 2, Duration(3) / Duration(2), Duration(3) // 2), (Duration(1.5), 1.5, Duration(1)))
        self.assertEqual((Duration(2) * 1.5, 2 * Duration(2), divmod(Duration(5), Duration(2))), (Duration(3), Duration(4), (2, Duration(1))))
        self.assertTrue(Time(1) < Time(1, 1) <= Time(1, 1) and Duration(1) > Duration(0) and not Duration())
        self.assertEqual((str(Time(1, 5)), repr(Duration(1)), Time.from_sec(1.5).to_nsec()), ("1000000005", "genpy.Duration[1000000000]", 1500000000))
        self.assertEqual(len({Time(1), Time(1, 0), Duration(1)}), 2)
        for wrong in (lambda: Time(-1), lambda: Time(1) < Duration(1), lambda: Time(1) + Time(1), lambda: Duration(1) + 1):
            with self.assertRaises(TypeError):
                wrong()
        with self.assertRaises(ValueError):
            Time(1.5, 5)


class Filling(Case):
    def filled(self, message, given, **keys):
        from genpy.message import fill_message_args

        fill_message_args(message, given, keys=keys)
        return message

    def test_lists_dictionaries_and_keys(self):
        from genpy import Duration, Time
        from geometry_msgs.msg import Twist
        from sensor_msgs.msg import JointState
        from std_msgs.msg import Header, String
        from trajectory_msgs.msg import JointTrajectory

        self.assertEqual(self.filled(String(), ["a"]).data, "a")
        self.assertEqual(self.filled(String(), [{"data": None}]).data, "")
        self.assertEqual(self.filled(String("as before"), [{}]).data, "as before")
        twist = self.filled(Twist(), [[1, 2, 3], {"z": 0.5}])
        self.assertEqual((twist.linear.y, twist.angular.x, twist.angular.z), (2, 0.0, 0.5))
        header = Header(frame_id="map")
        self.assertIs(self.filled(JointState(), [{"header": "auto", "position": (1, 2)}], auto=header).header, header)
        self.assertEqual(self.filled(Header(), [1, "now", "base"], now=Time(5, 6)).stamp, Time(5, 6))
        self.assertEqual(self.filled(Header(), [{"stamp": 2500000000}]).stamp, Time(2, 500000000))
        self.assertEqual(self.filled(Header(), [{"stamp": {"secs": 3, "nsecs": 4}}]).stamp, Time(3, 4))
        points = [{"time_from_start": 1500000000}, {"positions": [1, 2], "time_from_start": [4, 5]}]
        way = self.filled(JointTrajectory(), [{"points": points}])
        self.assertEqual([p.time_from_start for p in way.points], [Duration(1, 500000000), Duration(4, 5)])
        self.assertEqual(way.points[1].positions, [1, 2])

    def test_what_does_not_fit(self):
        from genpy import MessageException
        from geometry_msgs.msg import PoseWithCovariance, Twist
        from std_msgs.msg import Header, String
        from trajectory_msgs.msg import JointTrajectory

        for message, given, error, text in (
            (String(), [], MessageException, "Not enough arguments:\n * Given: []\n * Expected: ['data']"),
            (String(), ["a", "b"], MessageException, "Too many arguments:\n * Given: ['a', 'b']\n * Expected: ['data']"),
            (String(), None, MessageException, "Not enough arguments:\n * Given: []\n * Expected: ['data']"),
            (Twist(), [{"linear": {"w": 1}}], MessageException, "No field name [linear.w]"),
            (Twist(), [{"linear": 1}], ValueError, "invalid msg_args type: 1"),
            (Header(), [{"stamp": "now"}], MessageException, "No key named [now]"),
            (JointTrajectory(), [{"points": {}}], MessageException, "Field [points] must be a list or tuple instead of: dict"),
            (
                PoseWithCovariance(), [{"covariance": [1]}], MessageException,
                "Field [covariance] has incorrect number of elements: 1 != 36",
            ),
            (1, ["a"], ValueError, "msg must be a Message instance: 1"),
        ):  # fmt: skip
            with self.subTest(given), self.assertRaises(error) as raised:
                self.filled(message, given)
            self.assertEqual(str(raised.exception), text)


if __name__ == "__main__":
    unittest.main()
