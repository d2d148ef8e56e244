"""A callback that raises is told of in the log, and the next message is heard all the same."""
# stderr
import sys

import rospy
from std_msgs.msg import Int32


def bad(message):
    print("bad", message.data)
    if message.data == 1:
        raise ValueError("number %d" % message.data)
    if message.data == 2:
        sys.exit(3)


def good(message):
    print("good", message.data)


rospy.init_node("bad_callback")
publisher = rospy.Publisher("numbers", Int32, queue_size=10)
kept = [rospy.Subscriber("numbers", Int32, bad), rospy.Subscriber("numbers", Int32, good)]
rospy.sleep(0.7)
for number in (0, 1):
    publisher.publish(number)
    rospy.sleep(0.3)
print("end", rospy.is_shutdown())
