"""Several callbacks of a topic are called in the order of their subscribers, in one thread that is not the main one."""
import threading

import rospy
from std_msgs.msg import String

threads = {}


def made(name):
    def call(message):
        threads[name] = threading.current_thread()
        print(name, message.data)

    return call


rospy.init_node("callback_order")
publisher = rospy.Publisher("words", String, queue_size=10)
other = rospy.Publisher("others", String, queue_size=10)
kept = [rospy.Subscriber("words", String, made(name)) for name in ("a", "b", "c")]
kept.append(rospy.Subscriber("others", String, made("d")))
rospy.sleep(0.7)
publisher.publish("one")
publisher.publish("two")
rospy.sleep(0.5)
other.publish("three")
rospy.sleep(0.5)
print(threads["a"] is threads["b"] is threads["c"], threads["a"] is threads["d"], threads["a"] is threading.main_thread())
print(threads["a"].name, threads["d"].name, threads["a"].daemon)
kept[1].unregister()
publisher.publish("four")
rospy.sleep(0.5)
