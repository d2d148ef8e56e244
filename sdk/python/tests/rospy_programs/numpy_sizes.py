"""Arrays of NumPy with a size or a type of numbers that their field does not have."""
# needs: numpy
# departs: raises a `ROSSerializationException` for an array of NumPy with a size or dtype that makes the message unreadable; in rospy no subscriber hears of it
import numpy
import rospy
from geometry_msgs.msg import PoseWithCovariance
from rospy.numpy_msg import numpy_msg

rospy.init_node("numpy_sizes")
Pose = numpy_msg(PoseWithCovariance)
rospy.Subscriber("pose", Pose, lambda message: print("heard", message.covariance.tolist()[:3]))
publisher = rospy.Publisher("pose", Pose, queue_size=1)
rospy.sleep(0.7)
for covariance in (numpy.zeros(36), numpy.zeros(35), numpy.zeros(36, numpy.float32)):
    try:
        publisher.publish(Pose(covariance=covariance))
    except rospy.ROSSerializationException as error:
        print("refused:", error)
    rospy.sleep(0.3)
