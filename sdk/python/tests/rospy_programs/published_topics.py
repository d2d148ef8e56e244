"""What topics are there, and who listens when somebody comes."""
import rospy
from std_msgs.msg import Int32, String


class Listener(rospy.SubscribeListener):
    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        print("came", topic_name)
        peer_publish(Int32(1))

    def peer_unsubscribe(self, topic_name, num_peers):
        print("went", topic_name, num_peers)


rospy.init_node("published_topics")
number = rospy.Publisher("/test/number", Int32, Listener(), queue_size=1)
word = rospy.Publisher("~word", String, queue_size=1)
rospy.sleep(0.3)
print(sorted(rospy.get_published_topics("/test")), sorted(rospy.get_published_topics("/published_topics")), rospy.get_published_topics("/none"))
subscriber = rospy.Subscriber("/test/number", Int32, lambda m: print("heard", m.data))
rospy.sleep(0.7)
print(number.get_num_connections(), number.impl.has_connections())
subscriber.unregister()
rospy.sleep(0.5)
print(number.get_num_connections(), number.impl.has_connections())
master = rospy.get_master()
code, text, found = master.getPublishedTopics("/test")
print(code, found)
number.unregister()
rospy.sleep(0.2)
print(rospy.get_published_topics("/test"))
