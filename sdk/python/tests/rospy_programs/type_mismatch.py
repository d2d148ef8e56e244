"""A publisher and a subscriber of one topic with different types."""
# departs: a topic has one type, and who opens it with another is refused with a `ProtocolError`; in rospy the two are not connected, which only the log says
import rospy
from std_msgs.msg import Int32, String

rospy.init_node("type_mismatch")
publisher = rospy.Publisher("words", String, queue_size=1)
try:
    subscriber = rospy.Subscriber("words", Int32, lambda message: print("never"))
    rospy.sleep(0.7)
    publisher.publish("word")
    rospy.sleep(0.3)
    print(publisher.get_num_connections(), subscriber.get_num_connections())
except RuntimeError as error:
    print(type(error).__name__, error)
