"""A thread that goes on keeps the program from its end, and the node from its shutdown."""
import threading

import rospy

rospy.init_node("ends_with_thread")
rospy.on_shutdown(lambda: print("hook"))


def work():
    for turn in range(3):
        rospy.sleep(0.2)
        print("turn", turn, rospy.is_shutdown())


threading.Thread(target=work).start()
threading.Thread(target=lambda: (rospy.sleep(0.3), print("in between")), daemon=True).start()
daemon = threading.Thread(target=rospy.spin, daemon=True)
daemon.start()
print("last line")
