"""Handlers that raise, and handlers of errors."""
# stderr
import rospy
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node("service_errors")


def raising(error):
    def handle(request):
        raise error

    return handle


def told(error, kind, value, traceback):
    print("told:", type(error).__name__, error, kind.__name__, value is error, traceback is not None)


def called(name):
    try:
        print(rospy.ServiceProxy(name, Trigger)().message)
    except rospy.ServiceException as error:
        print(name, type(error).__name__, error)


kept = [
    rospy.Service("service_exception", Trigger, raising(rospy.ServiceException("not now"))),
    rospy.Service("value_error", Trigger, raising(ValueError("bad \u00fcmlaut"))),
    rospy.Service("ros_exception", Trigger, raising(rospy.ROSException("ros"))),
    rospy.Service("no_text", Trigger, raising(KeyError())),
    rospy.Service("with_handler", Trigger, raising(ValueError("bad")), error_handler=told),
    rospy.Service("good", Trigger, lambda request: TriggerResponse(True, "still there")),
]
for service in kept:
    called(service.resolved_name)
try:
    rospy.Service("good", Trigger, lambda request: None)
except Exception as error:
    print(type(error).__name__, error)
for name in ("", None, 5):
    try:
        rospy.Service(name, Trigger, lambda request: None)
    except Exception as error:
        print(repr(name), type(error).__name__, error)
print(issubclass(rospy.ServiceException, rospy.ROSException), rospy.ServiceException.__mro__[1].__name__)
