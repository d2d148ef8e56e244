"""Publishers and subscribers that leave, and how many are at the other end."""
import rospy
from std_msgs.msg import Int32

rospy.init_node("unregistering")
heard = []
first = rospy.Publisher("numbers", Int32, queue_size=5)
second = rospy.Publisher("numbers", Int32, queue_size=5)
one = rospy.Subscriber("numbers", Int32, lambda m: heard.append(("one", m.data)))
two = rospy.Subscriber("numbers", Int32, lambda m: heard.append(("two", m.data)))
rospy.sleep(0.7)


def shown(text):
    rospy.sleep(0.4)
    counts = []
    for each in (first, second, one, two):
        counts.append(each.get_num_connections() if each.impl is not None else None)
    print(text, counts, heard)
    del heard[:]


shown("begun")
first.publish(1)
shown("heard by both")
one.unregister()
second.publish(2)
shown("one is gone")
first.unregister()
second.publish(3)
shown("first is gone")
try:
    first.publish(4)
except Exception as error:
    print(type(error).__name__, error)
print(first.unregister(), one.unregister(), first.name, first.resolved_name, first.type, one.callback)
try:
    print(first.get_num_connections())
except Exception as error:
    print(type(error).__name__, error)
two.unregister()
second.publish(5)
shown("two is gone")
three = rospy.Subscriber("numbers", Int32, lambda m: heard.append(("three", m.data)))
rospy.sleep(0.7)
second.publish(6)
shown("three is there")
second.unregister()
shown("nobody publishes")
