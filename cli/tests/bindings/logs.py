"""What it hears becomes a line of the log."""

import rospy
from std_msgs.msg import Int8

LOGS = [rospy.logdebug, rospy.loginfo, rospy.loginfo, rospy.logwarn, rospy.loginfo, rospy.logfatal]

rospy.init_node("first")
rospy.Subscriber("/orders", Int8, lambda message: LOGS[message.data]("order %d", message.data))
rospy.loginfo("ready")
rospy.spin()
