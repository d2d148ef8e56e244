"""Where each level goes, and in which form; debug is left out."""
# stderr
import rospy

rospy.loginfo("before the node")
rospy.logwarn("a warning before the node")
rospy.init_node("logging_levels")
rospy.logdebug("debug")
rospy.loginfo("info")
rospy.logwarn("warning")
rospy.logerr("error")
rospy.logfatal("fatal")
rospy.logout("out")
rospy.loginfo("%s has %d of %.1f", "arm", 3, 2.55)
rospy.loginfo("100 %")
rospy.loginfo("%(a)s and %(b)s", {"a": 1, "b": 2})
rospy.loginfo(5)
rospy.loginfo(None)
rospy.loginfo(["a", 1])
rospy.loginfo(rospy.Time(1, 5))
rospy.loginfo(ValueError("an error"))
rospy.loginfo("two\nlines")
rospy.loginfo("")
rospy.loginfo("\u00fcmlaut")
rospy.loginfo("named", logger_name="planner")
try:
    1 / 0
except ZeroDivisionError:
    rospy.logerr("with the traceback", exc_info=True)
print(rospy.DEBUG, rospy.INFO, rospy.WARN, rospy.ERROR, rospy.FATAL)
