import rospy
from std_msgs.msg import String

rospy.init_node("brain")
rospy.Publisher("/ok", String, queue_size=1).publish("yes")
rospy.spin()
