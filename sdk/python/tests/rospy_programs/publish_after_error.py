"""What is heard on a topic after something was published that does not fit."""
# departs: a topic goes on after a `publish` that has raised; in rospy its subscribers hear nothing more of the publisher
import rospy
from std_msgs.msg import Int8

rospy.init_node("publish_after_error")
publisher = rospy.Publisher("numbers", Int8, queue_size=10)
rospy.Subscriber("numbers", Int8, lambda message: print("heard", message.data))
rospy.sleep(0.7)
for value in (1, "five", 2, 3):
    try:
        publisher.publish(value)
    except rospy.ROSSerializationException as error:
        print(error)
    rospy.sleep(0.3)
