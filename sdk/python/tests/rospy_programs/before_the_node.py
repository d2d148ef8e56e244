"""Publishers, subscribers and services that are made before the node, and work when it is there."""
import rospy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

publisher = rospy.Publisher("numbers", Int32, queue_size=5, latch=True)
subscriber = rospy.Subscriber("numbers", Int32, lambda m: print("heard", m.data))
proxy = rospy.ServiceProxy("trigger", Trigger)
print(publisher.name, subscriber.name, proxy.resolved_name, publisher.get_num_connections())
try:
    publisher.publish(1)
except rospy.ROSException as error:
    print(error)
print(rospy.Duration(1), rospy.Time(2), rospy.is_shutdown())
for call in (rospy.Time.now, lambda: rospy.Rate(1), lambda: rospy.sleep(0.1), rospy.get_time):
    try:
        print(call() is None)
    except rospy.ROSInitException as error:
        print(type(error).__name__, error)
rospy.init_node("before_the_node")
service = rospy.Service("trigger", Trigger, lambda request: (True, "done"))
rospy.sleep(0.7)
publisher.publish(2)
rospy.sleep(0.3)
print(proxy().message, publisher.get_num_connections())
