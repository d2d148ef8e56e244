"""`wait_for_message`: with what comes, with a timeout, with something latched, and with the end of the node."""
import threading

import rospy
from std_msgs.msg import String

rospy.init_node("wait_for_message")
start = rospy.get_time()
publisher = rospy.Publisher("words", String, queue_size=10)
latched = rospy.Publisher("latched", String, queue_size=10, latch=True)
latched.publish("kept")
timer = rospy.Timer(rospy.Duration(0.4), lambda event: publisher.publish("word"))


def tried(*args, **keys):
    begin = rospy.get_time()
    try:
        print(type(rospy.wait_for_message(*args, **keys)).__name__, rospy.get_time() - begin < 2.5)
    except Exception as error:
        print(type(error).__name__, error, "after %.1f s" % (rospy.get_time() - begin))


tried("words", String)
tried("words", String, 3)
tried("words", String, timeout=rospy.Duration(3))
tried("latched", String, timeout=1)
timer.shutdown()
rospy.sleep(0.5)
tried("words", String, timeout=0.5)
tried("/nothing", String, timeout=rospy.Duration(1))
tried("~private", String, 0.5)
tried("words", String, timeout=-1)
tried("words", int, timeout=1)
tried("", String, timeout=1)
threading.Thread(target=lambda: (rospy.sleep(1), rospy.signal_shutdown("enough"))).start()
try:
    rospy.wait_for_message("words", String)
except rospy.ROSInterruptException as error:
    print("interrupted:", error)
