"""An argument that is no remapping is told of, and the node does not begin."""
# arguments: a:=b x:=y:=z
# stderr
# code: 1
import rospy

print(sorted(rospy.names.get_mappings().items()))
rospy.init_node("bad_arguments")
print("never")
