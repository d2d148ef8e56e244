"""A slow callback and a queue of one: the newest message is heard after the first."""
import rospy
from std_msgs.msg import Int32

heard = []


def slow(message):
    heard.append(message.data)
    rospy.sleep(1.0)


rospy.init_node("queue_of_one")
publisher = rospy.Publisher("numbers", Int32, queue_size=100)
subscriber = rospy.Subscriber("numbers", Int32, slow, queue_size=1)
rospy.sleep(0.7)
publisher.publish(0)
rospy.sleep(0.3)
for number in range(1, 6):
    publisher.publish(number)
rospy.sleep(3.5)
print(heard)
