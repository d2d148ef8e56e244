"""`rospy.sleep` with what it may be given, and what not."""
import rospy

rospy.init_node("sleeps")
for duration in (0, 0.5, 1, -1, rospy.Duration(0.5), rospy.Duration(-2), rospy.Duration(), rospy.Duration(0, 300000000),
                 None, "1", rospy.Time(1), float("nan")):  # fmt: skip
    start = rospy.get_time()
    try:
        result = rospy.sleep(duration)
        print(repr(duration), result, "%.1f s" % (rospy.get_time() - start))
    except Exception as error:
        print(repr(duration), type(error).__name__, error)
