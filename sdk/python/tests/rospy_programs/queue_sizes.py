"""What sizes a queue may have, and what is said of one that has none."""
import warnings

import rospy
from std_msgs.msg import Int32

rospy.init_node("queue_sizes")


def tried(kind, **keys):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            made = kind("topic_%s" % kind.__name__, Int32, **keys)
            print(kind.__name__, keys, "made", [(w.category.__name__, str(w.message)[:60]) for w in caught if w.category is not DeprecationWarning])
            made.unregister()
        except Exception as error:
            print(kind.__name__, keys, type(error).__name__, error)


for size in (None, 0, 1, 10, -1, 2.5, "3", True):
    tried(rospy.Publisher, queue_size=size)
    tried(rospy.Subscriber, queue_size=size)
for size in (0, -1, 1, 2.5, "3"):
    tried(rospy.Subscriber, buff_size=size)
tried(rospy.Publisher)
tried(rospy.Subscriber)
