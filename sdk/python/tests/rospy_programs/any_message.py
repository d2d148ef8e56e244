"""Messages of any type, as bytes."""
import io

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import String

rospy.init_node("any_message")
publisher = rospy.Publisher("points", Point, queue_size=10)


def hear(message):
    header = message._connection_header
    point = Point().deserialize(message._buff)
    print(type(message).__name__, len(message._buff), point.x, point.y, point.z, header["type"], header["md5sum"], header["topic"])
    print(header["message_definition"].splitlines()[-3:])


rospy.Subscriber("points", rospy.AnyMsg, hear)
rospy.sleep(0.7)
publisher.publish(1, 2, 3)
rospy.sleep(0.3)
message = rospy.AnyMsg()
print(message._type, message._md5sum, message._has_header, message._full_text, message._buff, message.__slots__)
for wrong in (lambda: rospy.AnyMsg(1), lambda: message.serialize(io.BytesIO()), lambda: rospy.AnyMsg(x=1)):
    try:
        wrong()
    except Exception as error:
        print(type(error).__name__, str(error).split(".")[-1])
message.deserialize(b"\x02\x00\x00\x00hi")
buffer = io.BytesIO()
message.serialize(buffer)
print(buffer.getvalue())
words = rospy.Publisher("words", String, queue_size=10)
rospy.Subscriber("words", String, lambda m: print("word", m.data))
rospy.sleep(0.7)
words.publish(message)
rospy.sleep(0.3)
