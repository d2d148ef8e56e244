"""`rospkg`, `roslib`, `rosgraph` as far as they need no packages on the disk."""
import roslib
import rosgraph
import rosgraph.names
import rospkg
import rospy
import roslib.message
from std_msgs.msg import String

roslib.load_manifest("std_msgs")
print(roslib.message.get_message_class("std_msgs/String") is String)
try:
    rospkg.RosPack().get_path("no_such_package_at_all")
except rospkg.ResourceNotFound as error:
    print(type(error).__name__, str(error).splitlines()[0])
for name in ("a", "/a", "~a", "a/b", "", "1a", "a b", "a//b", "a/", "/", "~", "_a", "a-b", "\u00fc"):
    print(repr(name), rosgraph.names.is_legal_name(name), rosgraph.names.is_legal_base_name(name), rosgraph.names.is_global(name), rosgraph.names.is_private(name))
print(rosgraph.names.ns_join("/a", "b"), rosgraph.names.ns_join("/a/", "b"), rosgraph.names.ns_join("/a", "/b"), rosgraph.names.ns_join("a", "~b"), rosgraph.names.ns_join("", "b"))
print(rosgraph.names.namespace("/a/b/c"), rosgraph.names.namespace("/a"), rosgraph.names.namespace("/"), rosgraph.names.namespace("/a/b/"))
print(rosgraph.names.canonicalize_name("/a//b/"), rosgraph.names.canonicalize_name("a/"), rosgraph.names.resolve_name("~x", "/n/m"), rosgraph.names.resolve_name("x", "/n/m", {"/n/x": "/y"}))
print(rosgraph.names.load_mappings(["a:=b", "_c:=d", "__e:=f", "g", ":=h", "i:=", "j:=k:=l"]))
print(rosgraph.names.anonymous_name("base").startswith("base_"), rosgraph.names.make_caller_id("x"), rosgraph.names.script_resolve_name("/s", "x"))
for wrong in (None, 5):
    try:
        print(rosgraph.names.namespace(wrong))
    except Exception as error:
        print(type(error).__name__, error)
rospy.init_node("packages")
print(rosgraph.is_master_online(), rosgraph.Master("/packages").getTopicTypes() is not None)
