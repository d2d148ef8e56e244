"""Publishes a row that is shorter than the scenario's rule reads."""

import rospy
from std_msgs.msg import Float64MultiArray

rospy.init_node("brain")
rows = rospy.Publisher("/short", Float64MultiArray, queue_size=1)
rows.publish(Float64MultiArray(data=[1.0, 2.0]))
rospy.sleep(1)
