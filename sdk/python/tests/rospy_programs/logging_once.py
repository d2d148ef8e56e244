"""`_once`, `_throttle` and `_throttle_identical`, which tell calls apart by their places."""
# stderr
import rospy

rospy.init_node("logging_once")
for turn in range(3):
    rospy.loginfo_once("info %d", turn)
    rospy.loginfo_once("info %d", turn)
    rospy.logwarn_once("warning %d", turn)
    rospy.logerr_once("error %d", turn)
    rospy.logfatal_once("fatal %d", turn)
for turn in range(10):
    rospy.loginfo_throttle(1.0, "throttled %d" % turn)
    rospy.logwarn_throttle(0.5, "%s %d", "throttled, too", turn)
    rospy.logerr_throttle(0, "always %d" % turn)
    rospy.logfatal_throttle(100, "first %d" % turn)
    rospy.logout("turn %d" % turn)
    rospy.sleep(0.27)
for turn in range(10):
    rospy.loginfo_throttle_identical(1.0, "of %d" % (turn // 4))
    rospy.logwarn_throttle_identical(100, "same")
    rospy.logerr_throttle_identical(0, "no period %d" % (turn // 5))
    rospy.logfatal_throttle_identical(100, "text %d", turn)
    rospy.logwarn_throttle_identical(None, "none %d" % (turn // 5))
    rospy.sleep(0.27)
for wrong in (lambda: rospy.loginfo_throttle(1), lambda: rospy.loginfo_throttle("x", "text"), lambda: rospy.loginfo()):
    try:
        wrong()
    except Exception as error:
        print(type(error).__name__, error)
