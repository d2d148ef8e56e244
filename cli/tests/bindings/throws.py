import rospy
from std_msgs.msg import Int8


def order(message):
    print("order", message.data)
    raise ValueError("no such table")


rospy.init_node("brain")
rospy.Subscriber("/orders", Int8, order)
rospy.spin()
