import rospy
from std_msgs.msg import Int8

message = None


def order(heard):
    global message
    message = heard


rospy.init_node("brain")
rospy.Subscriber("/orders", Int8, order)
while message is None:
    pass
