"""The form of the log, when the environment says it."""
# stderr
# environment: ROSCONSOLE_FORMAT=[${severity}] [${logger}] [${node}] [${function}] ${message} (${file}:${line})
import os
import rospy

rospy.init_node("logging_format")


def work():
    rospy.loginfo("info of %s", "work")
    rospy.logwarn("warning")
    rospy.logerr_once("once")
    rospy.loginfo("named", logger_name="planner")


work()
rospy.logfatal("at the top")
