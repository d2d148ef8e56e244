"""Headers are counted by the publisher, in the message that the program has, too."""
import rospy
from geometry_msgs.msg import PointStamped
from std_msgs.msg import Header

rospy.init_node("header_numbers")
publisher = rospy.Publisher("points", PointStamped, queue_size=10)
headers = rospy.Publisher("headers", Header, queue_size=10)


def hear(message):
    print("heard", message.header.seq, repr(message.header.frame_id), message.header.stamp.to_sec(), message.point.x)


rospy.Subscriber("points", PointStamped, hear)
rospy.Subscriber("headers", Header, lambda m: print("header", m.seq, repr(m.frame_id)))
rospy.sleep(0.7)
message = PointStamped()
print(message.header.seq, repr(message.header.frame_id), message.header.stamp)
for _ in range(3):
    publisher.publish(message)
    rospy.sleep(0.2)
    print("mine", message.header.seq)
message.header.frame_id = None
message.header.stamp = rospy.Time(3, 500000000)
publisher.publish(message)
rospy.sleep(0.2)
print(repr(message.header.frame_id))
headers.publish(Header())
headers.publish(seq=9, frame_id="map")
rospy.sleep(0.2)
