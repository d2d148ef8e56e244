"""Reads and writes rows, asks where bodies are, and moves an arm by the names that it has here."""

import actionlib
import moveit_commander
import rospy
from gazebo_msgs.srv import GetModelState
from geometry_msgs.msg import PoseArray
from play_motion_msgs.msg import PlayMotionAction, PlayMotionGoal
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Float64, Float64MultiArray, Int8MultiArray


def rounded(*values):
    return " ".join("%.2f" % (value + 0.0) for value in values)


def pose(of):
    at, turn = of.position, of.orientation
    return "at %s turned %s" % (rounded(at.x, at.y, at.z), rounded(turn.x, turn.y, turn.z, turn.w))


rospy.init_node("brain")
print(rospy.get_param("/crane"), rospy.get_param("~names"))
scans = rospy.Publisher("/scan", LaserScan, queue_size=1)
slew = rospy.Publisher("/crane/slew_controller/command", Float64, queue_size=1)
unknown = rospy.Publisher("/crane/turn_controller/command", Float64, queue_size=1)

poses = rospy.wait_for_message("/poses", PoseArray)
for each in poses.poses:
    print(pose(each))
print(rospy.wait_for_message("/flags", Int8MultiArray).data)
row = rospy.wait_for_message("/row", Float64MultiArray)
print(row.data, [dim.size for dim in row.layout.dim])

for ranges in ([0.1], [1.0, 1.0, 1.0, 1.0], [1.0, 1.0, 0.1, 1.0]):
    scans.publish(LaserScan(ranges=ranges))

where = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState)
for name in ("crane", "cup", "moon"):
    found = where(name, "world")
    print(name, found.success, repr(found.status_message), pose(found.pose))

unknown.publish(0.1)
slew.publish(0.1)
rospy.sleep(1)
joints = rospy.wait_for_message("/joints", JointState)
print(joints.name, rounded(*joints.position))

client = actionlib.SimpleActionClient("/play_motion", PlayMotionAction)
client.wait_for_server()
for motion in ("aside", "dance"):
    state = client.send_goal_and_wait(PlayMotionGoal(motion_name=motion))
    print(motion, state, repr(client.get_goal_status_text()), client.get_result().error_code)
joints = rospy.wait_for_message("/joints", JointState)
print(joints.name, rounded(*joints.position))

for name in ("crane", "plain"):
    group = moveit_commander.MoveGroupCommander(name)
    print(name, group.get_active_joints(), group.get_end_effector_link(), group.get_named_targets())
group.set_named_target("home")
group.set_max_acceleration_scaling_factor(0.5)
print(group.go(wait=True), rounded(*group.get_current_joint_values()))


def duration(move):
    began = rospy.get_time()
    move()
    return rospy.get_time() - began


group.set_max_acceleration_scaling_factor(1.0)
by_itself = duration(lambda: client.send_goal_and_wait(PlayMotionGoal(motion_name="aside")))
by_plan = duration(lambda: group.go([0.0, 0.0], wait=True))
print("there by itself in %.2f s, and back by a plan in %.2f s" % (by_itself, by_plan))

# A posture with points: at the first in its time, at the others so long after it; from farther away it takes longer.
for before in ("home", "aside"):
    client.send_goal_and_wait(PlayMotionGoal(motion_name=before))
    began = rospy.get_time()
    state = client.send_goal_and_wait(PlayMotionGoal(motion_name="nod"))
    took, why = rospy.get_time() - began, repr(client.get_goal_status_text())
    joints = rospy.wait_for_message("/joints", JointState)
    print("nodded after %s in %.2f s:" % (before, took), state, why, rounded(*joints.position))
