"""The order of what is called at the end of a node, and what is told then."""
# stderr
import threading

import rospy
from std_msgs.msg import String

rospy.init_node("shutdown_hooks")
publisher = rospy.Publisher("last_words", String, queue_size=10)
heard = rospy.Subscriber("last_words", String, lambda m: print("heard", m.data))
rospy.sleep(0.7)


def first():
    print("first", rospy.is_shutdown(), rospy.core.is_shutdown_requested(), threading.current_thread() is threading.main_thread())
    publisher.publish("bye")
    rospy.sleep(0.3)


def bad():
    print("bad")
    raise ValueError("a bad hook")


for hook in (first, bad, lambda: print("third")):
    print(rospy.on_shutdown(hook))
rospy.core.add_preshutdown_hook(lambda reason: print("before", reason, rospy.is_shutdown()))
rospy.core.add_shutdown_hook(lambda reason: print("after", reason, rospy.is_shutdown()))
for wrong in (None, 5):
    try:
        rospy.on_shutdown(wrong)
    except TypeError as error:
        print(error)
print(rospy.signal_shutdown("enough is enough"), rospy.is_shutdown())
rospy.signal_shutdown("again")
rospy.on_shutdown(lambda: print("late"))
print("end of the program")
