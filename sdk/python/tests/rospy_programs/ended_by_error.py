"""A program that ends with an exception: its hooks are called all the same, and the code is 1."""
# stderr
# code: 1
import rospy

rospy.init_node("ended_by_error")
rospy.on_shutdown(lambda: print("hook"))
rospy.loginfo("on the way")
raise RuntimeError("it went wrong")
