"""Callbacks with arguments, methods, partial functions, several of one function, and callbacks with the wrong signature."""
# stderr
import functools

import rospy
from std_msgs.msg import Int32


class Listener:
    def __init__(self, name):
        self.name = name
        self.subscriber = rospy.Subscriber("numbers", Int32, self.hear)

    def hear(self, message):
        print("method of", self.name, message.data)

    def __call__(self, message, arguments):
        print("object", message.data, arguments)


def hear(message, arguments=None):
    print("function", message.data, arguments)


rospy.init_node("callback_arguments")
publisher = rospy.Publisher("numbers", Int32, queue_size=10)
listener, kept = Listener("first"), []
for arguments in ((1, 2), [3], {"a": 4}, "five", 0, None, False):
    kept.append(rospy.Subscriber("numbers", Int32, hear, arguments))
kept.append(rospy.Subscriber("numbers", Int32, listener, callback_args="given"))
kept.append(rospy.Subscriber("numbers", Int32, functools.partial(hear, arguments="partial")))
kept.append(rospy.Subscriber("numbers", Int32, lambda: print("never")))
kept.append(rospy.Subscriber("numbers", Int32, lambda message: print("last", message.data)))
rospy.sleep(0.7)
publisher.publish(1)
rospy.sleep(0.5)
kept[0].unregister()
kept[3].unregister()
publisher.publish(2)
rospy.sleep(0.5)
