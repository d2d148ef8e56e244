"""The exceptions of rospy, and what they are."""
import rospy
import rospy.exceptions
import rospy.service
import genpy

for name in (
    "ROSException", "ROSSerializationException", "ROSInitException", "ROSInterruptException", "ROSTimeMovedBackwardsException",
    "ROSInternalException", "TransportException", "TransportTerminated", "TransportInitError", "ServiceException",
):  # fmt: skip
    kind = getattr(rospy, name, None) or getattr(rospy.exceptions, name)
    print(name, [each.__name__ for each in kind.__mro__], kind.__module__)
error = rospy.exceptions.ROSTimeMovedBackwardsException(1.5)
print(error, error.time)
print(rospy.service.ServiceException is rospy.ServiceException, genpy.MessageException.__mro__[1].__name__)
print(rospy.rostime.Time is rospy.Time, rospy.topics.Publisher is rospy.Publisher, rospy.timer.Rate is rospy.Rate, rospy.msg.AnyMsg is rospy.AnyMsg)
try:
    raise rospy.ROSInterruptException("interrupted")
except KeyboardInterrupt as caught:
    print(type(caught).__name__, caught)
