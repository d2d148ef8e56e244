"""What a request and a response know of their connection, and counters of both sides."""
import rospy
from std_srvs.srv import SetBool, Trigger, TriggerRequest

rospy.init_node("service_headers")


def handle(request):
    header = request._connection_header
    print("request", header["callerid"], header["service"], header["md5sum"])
    return True, "done"


service = rospy.Service("trigger", Trigger, handle)
proxy = rospy.ServiceProxy("trigger", Trigger)
for _ in range(2):
    response = proxy(TriggerRequest())
    print(type(response).__name__, response.success, service.seq, proxy.seq)
print(service.resolved_name, service.uri.startswith("rosrpc://"), rospy.core.parse_rosrpc_uri("rosrpc://host:5/x"), service.done)
for uri in ("http://a:1", "rosrpc://host", "rosrpc://host:x"):
    try:
        rospy.core.parse_rosrpc_uri(uri)
    except Exception as error:
        print(type(error).__name__, error)
bound = [rospy.Service("~%s" % name, SetBool, lambda request, name=name: (request.data, name)) for name in ("a", "b")]
print([rospy.ServiceProxy("/service_headers/%s" % name, SetBool)(True).message for name in ("a", "b")])


class Robot:
    def __init__(self):
        self.count = 0
        self.service = rospy.Service("count", Trigger, self.count_up)

    def count_up(self, request):
        self.count += 1
        return self.count % 2 == 0, str(self.count)


robot = Robot()
print([(response.success, response.message) for response in (rospy.ServiceProxy("count", Trigger)() for _ in range(3))])
inner = rospy.Service("outer", Trigger, lambda request: rospy.ServiceProxy("count", Trigger)())
print(rospy.ServiceProxy("outer", Trigger)().message)
