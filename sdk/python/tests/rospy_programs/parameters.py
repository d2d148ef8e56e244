"""Parameters: values of all kinds, trees, defaults, and what is not there."""
# departs: `set_param` raises a `TypeError` for a root that is no dictionary, which rospy passes over
import rospy

rospy.init_node("parameters")


class Gains:
    def __init__(self):
        self.p, self.names = 1, ("a", "b")


def tried(call, *args):
    try:
        print(call.__name__, args, "->", repr(call(*args)))
    except BaseException as error:
        print(call.__name__, args, "!", type(error).__name__, error)


for value in (1, -5, 2.5, True, False, "text", "", "\u00fc", [1, 2.5, "x"], [], (1, 2), {"a": 1, "b": {"c": [1]}}, {}, [[1], [2]], [{"a": 1}],
              1e300, "true", "<&>", "line\nline", " blank ", 2**31 - 1, -(2**31)):  # fmt: skip
    tried(rospy.set_param, "/test/value", value)
    tried(rospy.get_param, "/test/value")
for value in (2**31, None, [None], {1: 2}, {1, 2}, rospy.Time(1), 1j, {"a": None}):
    tried(rospy.set_param, "/test/bad", value)
    tried(rospy.has_param, "/test/bad")
rospy.set_param("/test", {"gains": {"p": 1.5, "i": 0}, "name": "arm"})
for name in ("/test", "/test/", "/test/gains", "/test/gains/p", "/test/gains/d", "/test/name/more", "test/gains/p", "nothing", "/"):
    if name != "/":
        tried(rospy.get_param, name)
    tried(rospy.has_param, name)
tried(rospy.get_param, "nothing", 5)
tried(rospy.get_param, "nothing", None)
tried(rospy.get_param, "/test/gains/p", 5)
tried(rospy.delete_param, "/test/gains/i")
tried(rospy.get_param, "/test/gains")
tried(rospy.delete_param, "/test/gains/i")
tried(rospy.delete_param, "nothing")
tried(rospy.set_param, "/test/bytes", b"bytes")
tried(rospy.get_param, "/test/bytes/data")
tried(rospy.set_param, "/test/object", Gains())
tried(rospy.get_param, "/test/object")
tried(rospy.delete_param, "/test/object")
tried(rospy.delete_param, "/test/bytes")
tried(rospy.set_param, "/test/name/inner", 3)
tried(rospy.get_param, "/test")
found = rospy.get_param("/test/gains")
found["p"] = 99
tried(rospy.get_param, "/test/gains/p")
print(sorted(name for name in rospy.get_param_names() if name.startswith("/test")))
print(rospy.get_param("")["test"], rospy.get_param(None)["test"])
tried(rospy.set_param, "", 1)
tried(rospy.delete_param, "/test")
tried(rospy.has_param, "/test")
