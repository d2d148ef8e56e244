"""`message_filters`: messages that belong together, and a cache."""
import message_filters
import rospy
from geometry_msgs.msg import PointStamped
from std_msgs.msg import Int32

rospy.init_node("filters")
left, right = (rospy.Publisher(name, PointStamped, queue_size=10) for name in ("left", "right"))
subscribers = [message_filters.Subscriber(name, PointStamped) for name in ("left", "right")]
exact = message_filters.TimeSynchronizer(subscribers, 10)
exact.registerCallback(lambda a, b, more: print("exact", a.header.stamp.to_sec(), a.point.x, b.point.x, more), "more")
near = message_filters.ApproximateTimeSynchronizer(subscribers, 10, 0.1)
near.registerCallback(lambda a, b: print("near", a.header.stamp.to_sec(), b.header.stamp.to_sec()))
cache = message_filters.Cache(subscribers[0], 3)
rospy.sleep(0.7)


def sent(publisher, stamp, x):
    message = PointStamped()
    message.header.stamp, message.point.x = rospy.Time.from_sec(stamp), x
    publisher.publish(message)
    rospy.sleep(0.2)


for publisher, stamp, x in ((left, 1, 1), (right, 1, 2), (left, 2, 3), (right, 2.0625, 4), (left, 3, 5), (right, 3.5, 6), (left, 3.5, 7), (left, 4, 8)):
    sent(publisher, stamp, x)
print([each.point.x for each in cache.getInterval(rospy.Time(2), rospy.Time(3.5))], cache.getOldestTime(), cache.getLastestTime())
print(cache.getElemAfterTime(rospy.Time(3)).point.x, cache.getElemBeforeTime(rospy.Time(3.75)).point.x, cache.getLast().point.x)
print(cache.getElemAfterTime(rospy.Time(9)), cache.getElemBeforeTime(rospy.Time(0)))
numbers = rospy.Publisher("numbers", Int32, queue_size=10)
bare = message_filters.Cache(message_filters.Subscriber("numbers", Int32), 2, allow_headerless=True)
simple = message_filters.Subscriber("numbers", Int32)
simple.registerCallback(lambda message, *more: print("simple", message.data, more), 1, 2)
rospy.sleep(0.7)
numbers.publish(5)
rospy.sleep(0.3)
print(bare.getLast().data, len(bare.cache_msgs))
simple.sub.unregister()
