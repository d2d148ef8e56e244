"""A timer whose callback raises is over; another goes on, and a slow one catches up."""
import threading

import rospy

rospy.init_node("timer_errors")
threading.excepthook = lambda args: print("thread ended:", args.exc_type.__name__, args.exc_value)
start = rospy.get_time()
calls = []


def bad(event):
    print("bad")
    raise ValueError("no more")


def slow(event):
    calls.append("%.1f" % (rospy.get_time() - start))
    if len(calls) == 1:
        rospy.sleep(0.9)


first = rospy.Timer(rospy.Duration(0.3), bad)
second = rospy.Timer(rospy.Duration(0.5), slow)
rospy.sleep(2.8)
print(first.is_alive(), second.is_alive(), calls)
