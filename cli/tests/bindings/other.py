"""Says again what it hears, on a topic that the scenario does not know."""

import rospy
from std_msgs.msg import Int8

rospy.init_node("other")
again = rospy.Publisher("/again", Int8, queue_size=5)
rospy.Subscriber("/said", Int8, lambda message: again.publish(message.data + 1))
rospy.spin()
