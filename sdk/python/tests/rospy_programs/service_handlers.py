"""What the handler of a service may return, and what becomes of all else."""
import rospy
from std_msgs.msg import Bool
from std_srvs.srv import Empty, EmptyResponse, SetBoolResponse, Trigger, TriggerResponse
from nav_msgs.srv import SetMap, SetMapResponse

rospy.init_node("service_handlers")


def tried(name, kind, returned, *args):
    service = rospy.Service(name, kind, lambda request: returned)
    try:
        print(name, repr(returned), "->", repr(rospy.ServiceProxy(name, kind)(*args)))
    except Exception as error:
        print(name, repr(returned), "!", type(error).__name__, error)
    service.shutdown()


for number, returned in enumerate((
    TriggerResponse(True, "yes"), TriggerResponse(success=True), (True, "tuple"), [False, "list"], {"success": True, "message": "dict"},
    {"message": "part"}, {}, None, True, "text", 5, (True,), (True, "a", "b"), [], {"wrong": 1}, SetBoolResponse(True, "other"),
    (1, "number"), ("x", "not a bool"), (True, 5), {"success": "x"}, EmptyResponse(), object, iter([True, "x"]),
)):  # fmt: skip
    if callable(returned):
        returned = 2.5
    if hasattr(returned, "__next__"):
        continue
    tried("trigger_%d" % number, Trigger, returned)
for number, returned in enumerate((EmptyResponse(), None, [], {}, True, (1,), "")):
    tried("empty_%d" % number, Empty, returned)
for number, returned in enumerate((True, SetMapResponse(True), [True], (), {"success": True}, Bool(True), "x", None, 0)):
    tried("one_%d" % number, SetMap, returned)
