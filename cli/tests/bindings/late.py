"""Serves what another program asks for, and answers when that has gone."""

import rospy
from std_srvs.srv import SetBool, SetBoolResponse


def serve(request):
    print("asked", request.data)
    rospy.sleep(1.5)
    print("answers")
    return SetBoolResponse(True, "done")


rospy.init_node("brain")
service = rospy.Service("/slow", SetBool, serve)
rospy.sleep(3)
print("goes on")
