"""Drives pieces of the way."""

import threading

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.task import Future

PERIOD = 0.1  # seconds


class Wheels:
    """Says velocities again and again, since the base stops by itself when it hears nothing."""

    def __init__(self, node):
        self._speed = node.declare_parameter("speed", 0.1).value
        self._x = self._end = 0.0
        self._driven = None
        self._lock = threading.Lock()
        self._publisher = node.create_publisher(Twist, "cmd_vel", 10)
        group = MutuallyExclusiveCallbackGroup()
        node.create_subscription(Odometry, "odom", self._on_odometry, 10, callback_group=group)
        self._timer = node.create_timer(PERIOD, self._drive_on, callback_group=group)
        self._timer.cancel()

    def drive(self, length):
        """Sets out on a piece of so many metres. A future: whether it was driven to its end, or the robot braked."""
        with self._lock:
            self._driven = driven = Future()
            self._end = self._x + length
            self._drive_on()
            self._timer.reset()
        return driven

    def brake(self):
        """Stops, if it drives."""
        self._stop(False)

    def _drive_on(self):
        velocity = Twist()
        velocity.linear.x = self._speed
        self._publisher.publish(velocity)

    def _on_odometry(self, odometry):
        self._x = odometry.pose.pose.position.x
        if self._x >= self._end:
            self._stop(True)

    def _stop(self, is_whole):
        with self._lock:
            driven, self._driven = self._driven, None
            if driven is None:
                return
            self._timer.cancel()
            self._publisher.publish(Twist())
        driven.set_result(is_whole)
