"""A node whose level is debug, and the loggers of `logging`."""
# departs: the lines that rospy itself logs at the level debug, about its sockets, are not there
# departs: there is no topic `/rosout`, and no handler that sends to it
# stderr
import logging

import rospy

rospy.init_node("logging_debug", log_level=rospy.DEBUG)
rospy.logdebug("debug is shown")
rospy.loginfo("info is shown")
rosout = logging.getLogger("rosout")
print(rosout.level, [type(handler).__name__ for handler in rosout.handlers], bool(rosout.propagate))
rosout.warning("through logging")
rosout.getChild("planner").error("of a child")
logging.getLogger("rosout").setLevel(logging.ERROR)
rospy.logwarn("not shown")
rospy.logerr("shown")
logging.getLogger("another").info("of another logger")
