"""What `rosgraph` says of the master, and what this says of the graph."""
import rosgraph
import rosgraph.masterapi
import rosgraph.rosenv
import rospy
import std_srvs.srv
from std_msgs.msg import String


def tried(call):
    try:
        print(repr(call()))
    except Exception as error:
        print(type(error).__name__, [kind.__name__ for kind in type(error).__mro__[1:-3]], error)


print(rosgraph.myargv(["a", "b:=c", "-d", "_e:=f"]), rosgraph.ROS_NAMESPACE, rosgraph.ROS_IP, rosgraph.ROS_IPV6, rosgraph.ROS_HOSTNAME, rosgraph.ROS_MASTER_URI)
print(rosgraph.get_master_uri({}, []), rosgraph.get_master_uri({"ROS_MASTER_URI": "http://a:1"}, []), rosgraph.get_master_uri({}, ["__master:=http://b:2"]))
tried(lambda: rosgraph.get_master_uri({}, ["__master:="]))
tried(lambda: rosgraph.get_master_uri({}, ["__master:=a:=b"]))
api = rosgraph.masterapi
print(api.Error is rosgraph.MasterError, api.Failure is rosgraph.MasterFailure, api.ROSMasterException is rosgraph.MasterException, api.is_online is rosgraph.is_master_online)
print(rosgraph.rosenv.DEFAULT_MASTER_PORT, rosgraph.rosenv.DEFAULT_MASTER_URI)
tried(lambda: rosgraph.Master("a", "nonsense"))
tried(lambda: rosgraph.Master("a", ""))
tried(lambda: rosgraph.Master("~a"))
print(rosgraph.Master("a").caller_id, rosgraph.Master("/a/b/").caller_id)
print(rosgraph.is_master_online(), rosgraph.is_master_online("http://127.0.0.1:9"), rosgraph.Master("a").is_online())
rospy.init_node("robot")
master, nobody = rosgraph.Master("/ns/robot"), rosgraph.Master("a", "http://127.0.0.1:9")
for call in (lambda: nobody.getPid(), lambda: nobody.getParam("x"), lambda: nobody.getTopicTypes(), lambda: type(master.getPid()), lambda: master.getUri()[:7]):
    tried(call)
# Parameters, whose names are resolved with that of the caller.
for key in ("x", "/ns/y", "~p"):
    tried(lambda: master.setParam(key, 4))
    tried(lambda: (master.hasParam(key), master.getParam(key)))
tried(lambda: (master.getParam("/ns"), master.hasParam("/x")))
tried(lambda: master.getParam("z"))
tried(lambda: master.deleteParam("x"))
tried(lambda: master.deleteParam("x"))
tried(lambda: master.setParam("/a/b", {"c": 1}))
for key in ("a", "a/b/c", "zz", "p"):
    tried(lambda: master.searchParam(key))
tried(lambda: sorted(name for name in master.getParamNames() if name[:2] in ("/a", "/n")))
# Topics and services.
kept = [rospy.Publisher("/ns/t", String, queue_size=1), rospy.Publisher("/nst", String, queue_size=1), rospy.Subscriber("/ns/u", String)]
kept.append(rospy.Service("/ns/s", std_srvs.srv.Empty, lambda request: None))
for subgraph in ("", "/", "/ns", "/ns/", "ns", "t", "."):
    tried(lambda: sorted(pair for pair in master.getPublishedTopics(subgraph) if pair[0] != "/rosout"))
tried(lambda: sorted(pair for pair in master.getTopicTypes() if pair[0] != "/rosout"))
tried(lambda: [sorted(pair for pair in part if pair[0].startswith("/ns")) for part in master.getSystemState()])
for name in ("/ns/s", "s", "/nothing", ""):
    tried(lambda: master.lookupService(name)[:9])
