import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Int8

rospy.init_node("brain")
rospy.Publisher("/joint_states", JointState, queue_size=1).publish(JointState(name=["own"]))
rospy.Publisher("/echo", Int8, queue_size=1).publish(7)
rospy.sleep(0.5)
rospy.Publisher("/orders", Int8, queue_size=1).publish(9)
rospy.spin()
