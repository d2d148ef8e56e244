"""A node that shows warnings and worse."""
# stderr
import rospy

rospy.init_node("logging_warn_only", log_level=rospy.WARN)
rospy.logdebug("debug")
rospy.loginfo("info")
rospy.logwarn("warning")
rospy.logerr("error")
rospy.logfatal("fatal")
rospy.loginfo_once("once")
rospy.logwarn_once("once")
