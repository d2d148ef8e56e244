"""A program that ends without a word: its hooks are called then."""
# stderr
import atexit

import rospy

atexit.register(lambda: print("registered before"))
rospy.init_node("end_of_program")
atexit.register(lambda: print("registered after"))
rospy.on_shutdown(lambda: print("hook", rospy.is_shutdown()))
rospy.core.add_shutdown_hook(lambda reason: print("reason", reason))
rospy.Timer(rospy.Duration(0.2), lambda event: None)
print("last line")
