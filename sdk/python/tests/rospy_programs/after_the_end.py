"""What still works when the node is over, and what is said."""
import rospy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

rospy.init_node("after_the_end")
publisher = rospy.Publisher("numbers", Int32, queue_size=1)
service = rospy.Service("trigger", Trigger, lambda request: (True, "ok"))
proxy = rospy.ServiceProxy("trigger", Trigger)
rospy.set_param("~kept", 1)
rospy.signal_shutdown("over")


def tried(name, call):
    try:
        print(name, repr(call()))
    except BaseException as error:
        print(name, type(error).__name__, error)


tried("is_shutdown", rospy.is_shutdown)
tried("publish", lambda: publisher.publish(1))
tried("connections", publisher.get_num_connections)
tried("sleep", lambda: rospy.sleep(0.1))
tried("rate", lambda: rospy.Rate(10).sleep())
tried("wait_for_message", lambda: rospy.wait_for_message("numbers", Int32, 1))
tried("wait_for_service", lambda: rospy.wait_for_service("trigger"))
tried("wait_for_service, timeout", lambda: rospy.wait_for_service("trigger", 1))
tried("get_param", lambda: rospy.get_param("~kept"))
tried("get_name", rospy.get_name)
tried("spin", rospy.spin)
tried("unregister", publisher.unregister)
