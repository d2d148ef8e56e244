"""The arm and its gripper: take things from above, and put them down."""

import math

import actionlib
import moveit_commander
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import GripperCommandAction, GripperCommandGoal
from play_motion_msgs.msg import PlayMotionAction, PlayMotionGoal

ABOVE = 0.19  # m above their middle, from which things are approached
GRASP = 0.01  # m above their middle, where they are held
OPEN, CLOSED = 0.044, 0.0  # m, of each finger
RELEASE = 0.01  # m, above the ground
CARRIED_AHEAD, CARRIED_HEIGHT = 0.45, 0.90  # m, of the hand: so that what it holds passes above what stands on tables


class MotionError(Exception):
    """The arm did not come to where it was sent."""


class Arm(object):
    """MoveIt's group of torso and arm, and the gripper."""

    def __init__(self):
        self.group = moveit_commander.MoveGroupCommander("arm_torso")
        self.gripper = actionlib.SimpleActionClient("/parallel_gripper_controller/gripper_cmd", GripperCommandAction)
        self.motions = actionlib.SimpleActionClient("/play_motion", PlayMotionAction)
        self.gripper.wait_for_server()
        self.motions.wait_for_server()

    def move(self, x, y, z):
        """Brings the hand to a place."""
        self.group.set_position_target([x, y, z])
        arrived = self.group.go(wait=True)
        self.group.stop()
        self.group.clear_pose_targets()
        if not arrived:
            raise MotionError("cannot reach (%.2f, %.2f, %.2f)" % (x, y, z))

    def grip(self, width):
        """Opens or closes the hand; whether it holds something then."""
        goal = GripperCommandGoal()
        goal.command.position = width
        self.gripper.send_goal_and_wait(goal)
        return self.gripper.get_result().stalled

    def retreat(self):
        """Takes the arm close, so that the robot can drive."""
        goal = PlayMotionGoal(motion_name="carry")
        if self.motions.send_goal_and_wait(goal) != GoalStatus.SUCCEEDED:
            rospy.logwarn("the arm is not where it should be")

    def pick(self, place, base):
        """Takes what stands at a place, and holds it before the base, which is at (x, y, heading)."""
        x, y, z = place
        self.grip(OPEN)
        self.move(x, y, z + ABOVE)
        self.move(x, y, z + GRASP)
        if not self.grip(CLOSED):
            self.grip(OPEN)
            raise MotionError("there is nothing at (%.2f, %.2f)" % (x, y))
        self.move(x, y, z + ABOVE)
        x, y, heading = base
        self.move(x + CARRIED_AHEAD * math.cos(heading), y + CARRIED_AHEAD * math.sin(heading), CARRIED_HEIGHT)

    def place(self, place):
        """Puts down at a place what the hand holds."""
        x, y, z = place
        self.move(x, y, z + ABOVE)
        self.move(x, y, z + GRASP + RELEASE)
        self.grip(OPEN)
        self.move(x, y, z + ABOVE)
        self.retreat()
