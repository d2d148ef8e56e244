"""A slow callback and no limit: all messages are heard, in order."""
import rospy
from std_msgs.msg import Int32

heard = []


def slow(message):
    heard.append(message.data)
    rospy.sleep(0.1)


rospy.init_node("queue_without_end")
publisher = rospy.Publisher("numbers", Int32, queue_size=100)
rospy.Subscriber("numbers", Int32, slow)
rospy.sleep(0.7)
for number in range(20):
    publisher.publish(number)
rospy.sleep(4)
print(heard)
