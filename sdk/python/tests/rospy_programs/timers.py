"""Timers: how often and when they call, what they tell, and how they end."""
import threading

import rospy

rospy.init_node("timers")
start = rospy.Time.now()


def ago(time):
    return None if time is None else "%.1f" % (time - start).to_sec()


def tick(event):
    print(
        "tick", ago(event.last_expected), ago(event.last_real), ago(event.current_expected), ago(event.current_real),
        None if event.last_duration is None else "%.1f" % event.last_duration,
    )  # fmt: skip
    rospy.sleep(0.2)


timer = rospy.Timer(rospy.Duration(0.5), tick)
rospy.sleep(1.8)
timer.shutdown()
rospy.sleep(1)
print("once")
once = rospy.Timer(rospy.Duration(0.5), lambda event: print("event", sorted(vars(event))), oneshot=True)
print(isinstance(once, threading.Thread), once.daemon, once.is_alive(), timer.is_alive())
rospy.sleep(1)
print(once.is_alive())
never = rospy.Timer(rospy.Duration(0.5), lambda event: print("never"), True)
never.shutdown()
rospy.sleep(1)
print(never.is_alive())
for period in (rospy.Duration(-1), rospy.Duration(0)):
    threading.excepthook = lambda args: print(args.exc_type.__name__, args.exc_value)
    rospy.Timer(period, lambda event: print("soon"), oneshot=True)
    rospy.sleep(0.5)
rospy.Timer(1.0, lambda event: print("a number"))
rospy.sleep(0.2)
