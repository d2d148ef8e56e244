"""How a service can be called, and what is said of wrong calls."""
import rospy
from nav_msgs.srv import GetPlan, GetPlanRequest
from std_srvs.srv import Empty, EmptyRequest, SetBool, SetBoolRequest, SetBoolResponse, Trigger, TriggerRequest

rospy.init_node("service_calls")


def switch(request):
    print("handler", type(request).__name__, request.data)
    return SetBoolResponse(request.data, "it is %s" % request.data)


def plan(request):
    print("plan", request.start.header.frame_id, request.tolerance)
    return {}


kept = [rospy.Service("switch", SetBool, switch), rospy.Service("empty", Empty, lambda request: []), rospy.Service("plan", GetPlan, plan)]
switched, empty, planned = rospy.ServiceProxy("switch", SetBool), rospy.ServiceProxy("empty", Empty), rospy.ServiceProxy("plan", GetPlan)


def tried(call, *args, **keys):
    try:
        print(type(call).__name__, repr(call(*args, **keys)))
    except Exception as error:
        print(type(error).__name__, error)


tried(switched, True)
tried(switched, data=False)
tried(switched, SetBoolRequest(True))
tried(switched.call, True)
tried(switched.call, SetBoolRequest(data=False))
tried(switched)
tried(switched, True, False)
tried(switched, date=True)
tried(switched, True, data=True)
tried(switched, "text")
tried(switched, TriggerRequest())
tried(switched, 7)
tried(empty)
tried(empty, EmptyRequest())
tried(empty, 1)
tried(planned, tolerance=0.5)
tried(planned, GetPlanRequest())
tried(planned, 1, 2)
tried(planned, tolerance="x")
tried(rospy.ServiceProxy("nowhere", Trigger))
tried(rospy.ServiceProxy("switch", Trigger))
print(switched.resolved_name, switched.service_class.__name__, switched.request_class.__name__, switched.response_class.__name__)
print(kept[0].resolved_name, kept[0].service_class is SetBool, SetBool._type, SetBool._md5sum)
print(SetBool._request_class.__name__, SetBool._response_class._type, SetBoolRequest._md5sum, SetBoolRequest._slot_types)
