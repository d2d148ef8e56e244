"""The base: drives from place to place, and waits while something is near."""

import math

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool
from tf.transformations import euler_from_quaternion

FORWARD_SPEED = 0.25  # m/s
TURN_SPEED = 0.5  # rad/s
PERIOD = 0.1  # s, of a piece of a motion
NEAR_X, NEAR_Y = 0.1, 0.02  # m: nearer than that is there
STRAIGHT = 0.1  # rad: no need to turn
PATIENCE = 120.0  # s, for one way


class DriveError(Exception):
    """The base did not come to where it was sent."""


def wrap(angle):
    """The same angle, from -pi to pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


class Base(object):
    """Drives by velocities, a tenth of a second each, by odometry."""

    def __init__(self):
        self.near = False
        self.velocity = rospy.Publisher("/mobile_base_controller/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/collision", Bool, self.on_collision)

    def on_collision(self, message):
        if message.data and not self.near:
            rospy.logwarn("something is near")
        self.near = message.data

    def pose(self):
        """Where the base is, and where it looks."""
        pose = rospy.wait_for_message("/mobile_base_controller/odom", Odometry).pose.pose
        q = pose.orientation
        return pose.position.x, pose.position.y, euler_from_quaternion([q.x, q.y, q.z, q.w])[2]

    def go(self, forward, turn):
        """Goes on for one period."""
        twist = Twist()
        twist.linear.x = forward
        twist.angular.z = turn
        self.velocity.publish(twist)

    def drive_to(self, place):
        """Turns to a place, and drives there."""
        deadline = rospy.get_time() + PATIENCE
        x, y, heading = self.pose()
        while abs(place[0] - x) > NEAR_X or abs(place[1] - y) > NEAR_Y:
            if rospy.is_shutdown() or rospy.get_time() > deadline:
                raise DriveError("not there in time")
            error = wrap(math.atan2(place[1] - y, place[0] - x) - heading)
            if abs(error) > STRAIGHT:
                self.go(0.0, math.copysign(TURN_SPEED, error))
            elif self.near:
                self.go(0.0, 0.0)
            else:
                self.go(FORWARD_SPEED, 0.0)
            x, y, heading = self.pose()
        self.go(0.0, 0.0)

    def turn_to(self, goal):
        """Turns on the spot."""
        deadline = rospy.get_time() + PATIENCE
        error = wrap(goal - self.pose()[2])
        while abs(error) > STRAIGHT:
            if rospy.is_shutdown() or rospy.get_time() > deadline:
                raise DriveError("not turned in time")
            self.go(0.0, math.copysign(TURN_SPEED, error))
            error = wrap(goal - self.pose()[2])
        self.go(0.0, 0.0)
