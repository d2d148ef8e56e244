"""Private names, names from the command line, and the search for parameters."""
# arguments: __ns:=/robot/left _gain:=2 _name:=arm _on:=true _list:=[1,a,2.5] "_map:={x: 1, y: [a]}" "_odd:=[a:b, c]" _word:=a:b _text:="'7'" _real:=1e3 _float:=1.5 _octal:=010 file
import sys

import rospy

rospy.init_node("private_parameters", argv=sys.argv)


def tried(call, *args):
    try:
        print(call.__name__, args, "->", repr(call(*args)))
    except Exception as error:
        print(call.__name__, args, "!", type(error).__name__, error)


for name in ("gain", "name", "on", "list", "map", "word", "odd", "text", "real", "float", "octal"):
    tried(rospy.get_param, "~" + name)
tried(rospy.get_param, "~absent")
tried(rospy.get_param, "~absent", 3)
rospy.set_param("~own", 1)
rospy.set_param("of_namespace", 2)
rospy.set_param("/of_all", 3)
rospy.set_param("/robot/shared/deep", 4)
for name in ("~own", "own", "of_namespace", "/robot/left/of_namespace", "/of_all", "of_all", "/robot/left/private_parameters/own"):
    tried(rospy.get_param, name)
for name in ("own", "of_namespace", "of_all", "shared", "shared/deep", "shared/none", "/of_all", "/none", "none", "~own", "", "gain", "left"):
    tried(rospy.search_param, name)
tried(rospy.has_param, "~gain")
tried(rospy.delete_param, "~gain")
tried(rospy.has_param, "~gain")
print(sorted(rospy.get_param("~")))
print(sorted(name for name in rospy.get_param_names() if name.startswith("/robot/left")))
for name in ("~own", "of_namespace", "/of_all", "/robot"):
    tried(rospy.delete_param, name)
