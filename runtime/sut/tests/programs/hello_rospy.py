import rospy
import std_msgs.msg  # noqa: F401: as a node's messages are

rospy.init_node("hello")
