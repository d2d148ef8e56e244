"""Names of the node and of topics, and what the command line makes of them."""
# arguments: __name:=renamed __ns:=/over/there chatter:=/shared/talk inner:=deep/one ~own:=elsewhere /global:=here _p:=5 file.txt --flag :=empty
import os
import sys

import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger

early = rospy.Publisher("chatter", String, queue_size=1)
print(early.name, early.resolved_name)
rospy.init_node("remapping")
print(rospy.get_name(), rospy.get_namespace(), rospy.get_caller_id(), early.resolved_name)
for name in ("chatter", "/chatter", "inner", "deep", "~own", "~other", "/global", "global", "", "a/b/", "a//b", "~", "/", "chatter/more"):
    try:
        print(repr(name), rospy.resolve_name(name), rospy.remap_name(name))
    except Exception as error:
        print(repr(name), type(error).__name__, error)
print(rospy.resolve_name("a", caller_id="/x/y/z"), rospy.resolve_name("~a", "/x/y/z"))
print(rospy.Publisher("inner", String, queue_size=1).name, rospy.Subscriber("~own", String).name, rospy.Service("called", Trigger, None).resolved_name)
print([os.path.basename(word) for word in rospy.myargv()], rospy.myargv(["a", "b:=c", "__x:=y", "d"]), len(sys.argv))
print(sorted(rospy.names.get_mappings().items()))
print(rospy.get_param("~p"))
