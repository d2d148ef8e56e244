"""`Rate`: what remains, loops that are late, and what it is made of."""
import time

import rospy

rospy.init_node("rates")
rate = rospy.Rate(2)
start = rospy.get_time()


def shown(text):
    print("%s at %.1f s, %.1f s remain" % (text, rospy.get_time() - start, rate.remaining().to_sec()))


print(repr(rate.sleep_dur), type(rate.sleep_dur).__name__, type(rate.remaining()).__name__, type(rate.last_time).__name__)
print(rospy.Rate(3).sleep_dur.to_nsec(), rospy.Rate(0.5).sleep_dur.to_sec(), rospy.Rate(1000).sleep_dur)
shown("begun")
rate.sleep()
shown("first")
time.sleep(0.2)
shown("worked")
rate.sleep()
shown("second")
time.sleep(0.8)
shown("late")
rate.sleep()
shown("third")
rate.sleep()
shown("fourth")
time.sleep(2.3)
shown("much too late")
rate.sleep()
shown("fifth")
rate.sleep()
shown("sixth")
rate.last_time = rospy.Time.now()
shown("set")
for hz in (0, -1, None, "2"):
    try:
        print(hz, rospy.Rate(hz).sleep_dur)
    except Exception as error:
        print(hz, type(error).__name__, error)
print(rospy.Rate(10, reset=True)._reset, rospy.Rate(hz=10)._reset)
