"""A parameter of the command line that holds no value: what stands before the comma is a key."""
# arguments: "_none:={z:1, y: 2}"
import rospy

try:
    rospy.init_node("bad_parameter")
except Exception as error:
    print(type(error).__name__, error)
print(rospy.core.is_initialized())
