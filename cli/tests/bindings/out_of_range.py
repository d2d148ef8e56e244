import rospy
from std_msgs.msg import Int8

rospy.init_node("brain")
pub = rospy.Publisher("/ok", Int8, queue_size=1)
rospy.sleep(1)
pub.publish(77)
rospy.sleep(1)
