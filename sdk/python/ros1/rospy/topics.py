"""Publishers and subscribers, by the name of the module in which rospy has them."""

from genpy import Message
from rospy.publishers import Publisher, SubscribeListener
from rospy.subscribers import Subscriber
from rospy.topic import Topic

__all__ = ["Message", "Publisher", "SubscribeListener", "Subscriber", "Topic"]
