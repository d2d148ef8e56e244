"""A timer that throws, after an order was answered too late."""

import rospy
from std_msgs.msg import Int8


def tick(event):
    raise NotImplementedError("what this timer is for")


rospy.init_node("brain", anonymous=False)
rospy.Timer(rospy.Duration(3.5), tick)
rospy.Subscriber("/orders", Int8, lambda message: print("order", message.data))
rospy.sleep(60)
