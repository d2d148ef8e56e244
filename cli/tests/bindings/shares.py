"""Two nodes that find and set the same parameters, each in its turn."""

import rospy

rospy.init_node("first")
if rospy.get_name() == "/first":
    print(rospy.get_param("/order"), rospy.has_param("~said"), rospy.search_param("most"))
    rospy.set_param("~asks", {"how": "many", "least": [1, 2.5, True]})
    rospy.sleep(1)
    print(rospy.get_param("~said"), rospy.has_param("~asks"), sorted(rospy.get_param_names()))
    rospy.delete_param("/order/most")
else:
    print(rospy.get_param("/first/asks"), rospy.get_param("/first/asks/least"))
    rospy.set_param("/first/said", rospy.get_param("/order/most"))
    rospy.delete_param("/first/asks")
    rospy.sleep(2)
    print(rospy.get_param("/order"), rospy.get_param("/order/most", "none"))
rospy.sleep(3)
