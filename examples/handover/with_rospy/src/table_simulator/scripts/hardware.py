"""Arm, gripper, voice and sensors of the robot, as ROS shows them."""

import math
import threading
from collections import deque

import actionlib
import moveit_commander
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import GripperCommandAction, GripperCommandGoal
from std_msgs.msg import Empty, Float64
from std_srvs.srv import Trigger

from table_simulator.msg import Readings, Voice

SET_POINT_RATE = 100  # Hz
CONTROLLER_LAG = 0.1  # s: a joint comes nearer to its set-point by a tenth of what is left in each period
MAX_JOINT_SPEED = 1.0  # rad/s, as in joint_limits.yaml
MAX_JOINT_ACCELERATION = 1.0  # rad/s^2, as in joint_limits.yaml
RAMP_TIME = 0.5  # s, to come to full speed and to stop
ARRIVAL_TIMEOUT = 1.0  # s, from the last set-point
PLACE_TOLERANCE = 0.005  # m
JOINT_TOLERANCE = 0.01  # rad
SETTLED_SPEED = 0.02  # rad/s

GRIPPER_OPEN = 0.07  # m, between the fingers
GRIPPER_CLOSED = 0.0


class MotionError(Exception):
    """The arm did not reach the place it was sent to."""


class Arm(object):
    """Moves along MoveIt's plans by set-points for the joints' position controllers, so that the code has its speed in hand."""

    def __init__(self, group):
        self.group = moveit_commander.MoveGroupCommander(group)
        topic = "/%s/%%s_position_controller/command" % group
        self.controllers = [
            rospy.Publisher(topic % joint, Float64, queue_size=1) for joint in self.group.get_active_joints()
        ]

    def move_to(self, place, speed):
        """Moves the hand to a place, or raises `MotionError`."""
        self.group.set_position_target(list(place))
        points = self.plan(speed)
        if points is None:
            raise MotionError("cannot reach %s: there is no plan" % (place,))
        if not self.follow(points, lambda: self.distance_to(place) <= PLACE_TOLERANCE):
            raise MotionError("cannot reach %s: %.3f m are left" % (place, self.distance_to(place)))

    def move_joints(self, posture, speed):
        """Moves the joints, or raises `MotionError`."""
        self.group.set_joint_value_target(list(posture))
        points = self.plan(speed)
        if points is None or not self.follow(points, lambda: self.is_in(posture)):
            raise MotionError("cannot take the posture %s" % (posture,))

    def plan(self, speed):
        """The points of the way to the target, or None."""
        self.group.set_max_velocity_scaling_factor(speed / MAX_JOINT_SPEED)
        self.group.set_max_acceleration_scaling_factor(speed / RAMP_TIME / MAX_JOINT_ACCELERATION)
        self.group.set_start_state_to_current_state()
        success, trajectory, _, _ = self.group.plan()
        self.group.clear_pose_targets()
        return trajectory.joint_trajectory.points if success else None

    def follow(self, points, has_arrived):
        """Streams set-points along the plan; whether the arm has arrived, and stands."""
        rate = rospy.Rate(SET_POINT_RATE)
        before = None
        for set_point in set_points(points):
            if before is not None:
                rate.sleep()
            before = set_point
            for controller, position in zip(self.controllers, set_point):
                controller.publish(position)
        deadline = rospy.get_time() + ARRIVAL_TIMEOUT
        before = self.group.get_current_joint_values()
        while not rospy.is_shutdown():
            rate.sleep()
            now = self.group.get_current_joint_values()
            speed = max(abs(b - a) for a, b in zip(before, now)) * SET_POINT_RATE
            if speed < SETTLED_SPEED and has_arrived():
                return True
            if rospy.get_time() > deadline:
                return False
            before = now
        return False

    def distance_to(self, place):
        """From the hand, in metres."""
        at = self.group.get_current_pose().pose.position
        return math.sqrt(sum((a - b) ** 2 for a, b in zip((at.x, at.y, at.z), place)))

    def is_in(self, posture):
        """Whether all joints are where they should be."""
        joints = self.group.get_current_joint_values()
        return all(abs(a - b) <= JOINT_TOLERANCE for a, b in zip(joints, posture))


def set_points(points):
    """Set-points of the joints along a plan, one for each period of the controllers: as far ahead of the plan as the joints
    come after them. The last one is the plan's end, and is for the period in which the plan ends."""
    at = 0
    before = points[0].positions
    for period in range(1, int(math.ceil(points[-1].time_from_start.to_sec() * SET_POINT_RATE))):
        time = float(period) / SET_POINT_RATE
        while points[at + 1].time_from_start.to_sec() <= time:
            at += 1
        after = between(points[at], points[at + 1], time)
        yield [a + (b - a) * CONTROLLER_LAG * SET_POINT_RATE for a, b in zip(before, after)]
        before = after
    yield points[-1].positions


def between(begin, end, time):
    """The joints' positions at a time between two points of a plan: cubic, with the points' velocities."""
    start = begin.time_from_start.to_sec()
    span = end.time_from_start.to_sec() - start
    u = (time - start) / span
    p0, m0 = (1 + 2 * u) * (1 - u) ** 2, u * (1 - u) ** 2 * span
    p1, m1 = u * u * (3 - 2 * u), u * u * (u - 1) * span
    return [
        p0 * q0 + m0 * v0 + p1 * q1 + m1 * v1
        for q0, v0, q1, v1 in zip(begin.positions, begin.velocities, end.positions, end.velocities)
    ]


class Gripper(object):
    """The hand, as an action."""

    def __init__(self, action):
        self.client = actionlib.SimpleActionClient(action, GripperCommandAction)
        self.client.wait_for_server()

    def open(self):
        """Whether the hand is open."""
        return self.command(GRIPPER_OPEN) == GoalStatus.SUCCEEDED

    def close(self):
        """Whether the hand now holds something: its fingers do not meet."""
        self.command(GRIPPER_CLOSED)
        return self.client.get_result().stalled

    def command(self, position):
        goal = GripperCommandGoal()
        goal.command.position = position
        return self.client.send_goal_and_wait(goal)


class Inbox(object):
    """What callbacks have put aside for the state machine's thread."""

    def __init__(self):
        self.items = deque()
        self.filled = threading.Event()

    def put(self, item):
        self.items.append(item)
        self.filled.set()

    def get(self, timeout):
        """The oldest item; None if there is none in time."""
        if not self.items:
            self.filled.wait(timeout)
        if not self.items:
            return None
        item = self.items.popleft()
        if not self.items:
            self.filled.clear()
        return item

    def clear(self):
        self.items.clear()
        self.filled.clear()


class Ears(object):
    """What the person has said and the robot has not yet taken notice of."""

    def __init__(self):
        self.heard = {"leg_request": Inbox(), "human_ready": Inbox()}
        self.last = dict.fromkeys(self.heard, rospy.Time(0))
        self.subscribe()

    def subscribe(self):
        rospy.Subscriber("/human/voice", Voice, self.on_voice)

    def on_voice(self, message):
        # The topic is latched: each new subscriber is told once more what was said last.
        for command, inbox in self.heard.items():
            if getattr(message, command) and message.header.stamp > self.last[command]:
                self.last[command] = message.header.stamp
                inbox.put(message.header.stamp)

    def wait_for(self, command, polls, period):
        """The time at which the command was given, or None."""
        for _ in range(polls):
            self.subscribe()  # the recogniser is restarted now and then
            said = self.heard[command].get(period)
            if said is not None:
                return said
        return None

    def forget(self, command):
        """Takes no notice of what was said until now."""
        self.heard[command].clear()


class Sensors(object):
    """Gaze, grip pressure and place of the person's hand."""

    def __init__(self):
        self.answers = Inbox()
        self.request = rospy.Publisher("/sensors/request", Empty, queue_size=1)
        rospy.Subscriber("/sensors/readings", Readings, self.answers.put)
        rospy.wait_for_service("/sensors/grip_is_felt")
        self.felt = rospy.ServiceProxy("/sensors/grip_is_felt", Trigger)

    def ask(self, timeout):
        """The sensors' readings, or None if they do not answer in time."""
        self.request.publish()
        return self.answers.get(timeout)

    def grip_is_felt(self):
        """Whether the person holds what the robot holds."""
        return self.felt().success

    def forget(self):
        """Takes no notice of late answers."""
        self.answers.clear()
