"""`Time`: how it is made, printed, compared and calculated with."""
import copy
import pickle

import genpy
import rospy
from rospy import Duration, Time


def tried(text):
    try:
        print(text, "=", repr(eval(text)))
    except Exception as error:
        print(text, "!", type(error).__name__, error)


tried("Time.now()")
tried("rospy.get_rostime()")
tried("rospy.get_time()")
rospy.init_node("times")
for text in (
    "Time()", "Time(1)", "Time(1.5)", "Time(-1)", "Time(-0.5)", "Time(1, 1500000000)", "Time(1, -1)", "Time(0, -1)",
    "Time(1.5, 5)", "Time('1')", "Time(secs=1, nsecs=2)", "Time(0.1)", "Time(1700000000.123456789)", "Time.from_sec(2.25)",
    "Time.from_sec(-1)", "Time.from_seconds(2.25)", "str(Time(1.5))", "Time(1.5).secs", "Time(1.5).nsecs", "Time(1.5).to_sec()",
    "Time(1.5).to_nsec()", "Time(1.5).to_time()", "Time(1) + Duration(0.5)", "Duration(0.5) + Time(1)", "Time(1) - Duration(0.5)",
    "Time(1) - Duration(2)", "Time(2) - Time(0.5)", "Time(1) - Time(2)", "Time(1) + Time(1)", "Time(1) + 1", "Time(1) - 1",
    "1 + Time(1)", "Duration(1) - Time(1)", "Time(1) * 2", "-Time(1)", "abs(Time(1))", "bool(Time())", "bool(Time(1))", "float(Time(1))",
    "Time(1) == Time(1)", "Time(1) == 1", "Time(1) != Time(1, 1)", "Time(1) == genpy.Time(1)", "Time(1) < Time(2)",
    "Time(1) < 2", "Time(1) >= Time(1)", "Time(1) > Duration(1)", "Time(1) == Duration(1)", "Time(1) <= None",
    "len({Time(1), Time(1), genpy.Time(1)})", "sorted([Time(2), Time(1)])", "Time(1).is_zero()", "Time().is_zero()",
    "copy.copy(Time(1, 2))", "pickle.loads(pickle.dumps(Time(1, 2)))", "genpy.Time(1, 2)", "genpy.TVal(1, 2)",
    "type(Time(1) + Duration(1)).__module__", "type(Time(1) - Duration(1)).__module__", "type(Time(1) - Time(1)).__module__",
    "isinstance(Time(), genpy.Time)", "isinstance(rospy.get_rostime(), Time)", "type(rospy.get_time())", "type(Time.now())",
    "Time.now() >= rospy.get_rostime() - Duration(1)", "Time.now().to_sec() > 1700000000", "Time(1).foo", "Time(1).set(3, 4)",
    "Time.__slots__", "Time(10**10)", "Time(None)", "'%s %r' % (Time(2), Time(2))",
):  # fmt: skip
    tried(text)
stamp = Time(5, 5)
stamp.secs += 1
stamp.set(7, 1500000000)
stamp.canon()
print(stamp, stamp.secs, stamp.nsecs)
