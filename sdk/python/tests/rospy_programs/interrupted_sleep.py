"""An interrupt during a pause, and in a loop of the usual kind."""
import os
import signal
import threading

import rospy

rospy.init_node("interrupted_sleep")
rospy.on_shutdown(lambda: print("hook"))
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
rate = rospy.Rate(10)
turns = 0
try:
    while not rospy.is_shutdown():
        turns += 1
        rate.sleep()
    print("the loop has ended", 4 <= turns <= 8)
except rospy.ROSInterruptException:
    print("interrupted")
