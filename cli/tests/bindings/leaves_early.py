"""Asks in a thread of its own, and ends before there is an answer."""

import threading

import rospy
from std_srvs.srv import SetBool

rospy.init_node("other")
rospy.wait_for_service("/slow")
threading.Thread(target=rospy.ServiceProxy("/slow", SetBool), args=(True,), daemon=True).start()
rospy.sleep(0.5)
print("leaves")
