"""`rospy.spin` ends when a timer ends the node; a loop of the usual kind does, too."""
import threading

import rospy

rospy.init_node("spin_and_timer")
start = rospy.get_time()
rospy.on_shutdown(lambda: print("hook"))
turns = []


def loop():
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        turns.append(1)
        rate.sleep()
    print("loop over")


worker = threading.Thread(target=loop)
worker.start()
rospy.Timer(rospy.Duration(1), lambda event: rospy.signal_shutdown("timer"), oneshot=True)
rospy.spin()
worker.join()
print("spin over", 1 <= rospy.get_time() - start < 2, 9 <= len(turns) <= 12, rospy.is_shutdown())
rospy.spin()
rospy.sleep(0.1)
print("slept")
