"""Who comes late gets the last message of a latched topic, and nothing of another."""
import rospy
from std_msgs.msg import Int32

rospy.init_node("latching")
latched = rospy.Publisher("latched", Int32, queue_size=5, latch=True)
plain = rospy.Publisher("plain", Int32, queue_size=5)
for number in range(3):
    latched.publish(number)
    plain.publish(number)


def hear(message, name):
    header = message._connection_header
    print(name, message.data, sorted(header), header["latching"], header["topic"], header["type"], header["callerid"])


rospy.Subscriber("latched", Int32, hear, callback_args="first")
rospy.Subscriber("plain", Int32, hear, callback_args="plain")
rospy.sleep(0.5)
rospy.Subscriber("latched", Int32, hear, callback_args="second")
rospy.sleep(0.5)
latched.publish(7)
rospy.sleep(0.5)
plain.publish(8)
rospy.sleep(0.5)
print(latched.impl.is_latch, plain.impl.is_latch, latched.get_num_connections())
