"""The services of a node for its loggers, and the topic of its log."""
# departs: a node has no services for its loggers; the level is set in `init_node` or by `logging`
# departs: there is no topic `/rosout`, and no handler that sends to it
import rospy
from roscpp.srv import GetLoggers, SetLoggerLevel
from rosgraph_msgs.msg import Log

rospy.init_node("loggers")
rospy.Subscriber("/rosout", Log, lambda message: print("rosout:", message.level, message.name, message.msg))
rospy.sleep(0.7)
rospy.logwarn("a warning")
rospy.sleep(0.3)
for kind, name, args in ((SetLoggerLevel, "~set_logger_level", ("rosout", "error")), (GetLoggers, "~get_loggers", ())):
    try:
        response = rospy.ServiceProxy(name, kind)(*args)
        print(name, [(each.name, each.level) for each in getattr(response, "loggers", []) if each.name == "rosout"])
    except rospy.ServiceException as error:
        print(error)
rospy.logwarn("not shown")
rospy.logerr("shown")
rospy.sleep(0.3)
