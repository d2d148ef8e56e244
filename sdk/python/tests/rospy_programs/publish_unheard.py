"""What does not fit, published while nobody listens."""
# departs: what `publish` is given is checked whether or not anybody listens, since it is told to the scenario
import rospy
from std_msgs.msg import Int8

rospy.init_node("publish_unheard")
plain = rospy.Publisher("plain", Int8, queue_size=1)
latched = rospy.Publisher("latched", Int8, queue_size=1, latch=True)
for publisher in (plain, latched):
    for value in (5, 300, "five"):
        try:
            print(publisher.name, value, publisher.publish(value))
        except Exception as error:
            print(publisher.name, value, type(error).__name__, error)
try:
    plain.publish(1, 2)
except Exception as error:
    print(type(error).__name__, error)
