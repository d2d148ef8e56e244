import rospy

rospy.init_node("brain")
rospy.sleep(2)
raise RuntimeError("a wheel came off")
