"""What signals do to a node."""
import os
import signal

import rospy

rospy.init_node("signals")
rospy.on_shutdown(lambda: print("hook"))
rospy.core.add_shutdown_hook(lambda reason: print("reason", reason))
print(signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL)
rospy.Timer(rospy.Duration(0.5), lambda event: os.kill(os.getpid(), signal.SIGINT), oneshot=True)
rospy.spin()
print("spun", rospy.is_shutdown())
