"""Parameters of the cache, which are those of the server."""
# departs: `get_param_cached` reads the tree anew each time, and hands out a copy; rospy's cache keeps a tree as it was, and a program can change it there
import rospy

rospy.init_node("parameters_cached")
rospy.set_param("/test", {"gains": {"p": 1.5}, "name": "arm"})
print(rospy.get_param_cached("/test/name"), rospy.get_param_cached("/none", "default"), rospy.get_param_cached("/test/gains"))
try:
    rospy.get_param_cached("/none")
except KeyError as error:
    print(error)
rospy.set_param("/test/name", "leg")
rospy.sleep(0.2)
print(rospy.get_param_cached("/test/name"), rospy.get_param("/test/name"))
found = rospy.get_param_cached("/test/gains")
found["p"] = 99
print(rospy.get_param_cached("/test/gains/p"), rospy.get_param("/test/gains"))
rospy.set_param("/test/name", "wheel")
print(rospy.get_param_cached("/test"))
