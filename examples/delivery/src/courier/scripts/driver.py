#!/usr/bin/env python3
"""Drives the base to places, and brakes for whoever is in the way.

    rosrun courier driver.py

Action     ~drive_to (courier/DriveTo)
Services   ~enable (std_srvs/SetBool), ~clearance (courier/Clearance)
Hears      scan (sensor_msgs/LaserScan), odom (nav_msgs/Odometry)
Publishes  cmd_vel (geometry_msgs/Twist)
Parameters ~rate, ~max_speed, ~max_turn, ~stop_distance, ~slow_distance, ~half_width, ~patience, ~scan_timeout, ~tolerance
"""

import math
import threading

import actionlib
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool, SetBoolResponse
from tf.transformations import euler_from_quaternion

from courier.motion import allowed_speed, clearance, steer
from courier.msg import DriveToAction, DriveToFeedback, DriveToResult
from courier.srv import Clearance, ClearanceResponse


class Driver(object):
    """One goal at a time, in the thread of the action server; scans and odometry come in those of their topics."""

    def __init__(self):
        self.rate = rospy.get_param("~rate", 10.0)  # Hz
        self.max_speed = rospy.get_param("~max_speed", 0.5)  # m/s
        self.max_turn = rospy.get_param("~max_turn", 1.0)  # rad/s
        self.stop_distance = rospy.get_param("~stop_distance", 0.45)  # m, from the scanner
        self.slow_distance = rospy.get_param("~slow_distance", 1.5)
        self.half_width = rospy.get_param("~half_width", 0.35)
        self.patience = rospy.Duration(rospy.get_param("~patience", 12.0))  # s, of a way that is blocked
        self.scan_timeout = rospy.Duration(rospy.get_param("~scan_timeout", 0.5))
        self.tolerance = rospy.get_param("~tolerance", 0.08)  # m

        self.lock = threading.Lock()
        self.pose = None
        self.scan = None
        self.enabled = False

        self.cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan, queue_size=1)
        rospy.Service("~enable", SetBool, self.on_enable)
        rospy.Service("~clearance", Clearance, self.on_clearance)
        self.server = actionlib.SimpleActionServer("~drive_to", DriveToAction, self.drive_to, auto_start=False)
        self.server.start()
        rospy.on_shutdown(self.stop)

    # -- what it hears ------------------------------------------------------------------------------------------------

    def on_odom(self, message):
        pose = message.pose.pose
        q = pose.orientation
        heading = euler_from_quaternion([q.x, q.y, q.z, q.w])[2]
        with self.lock:
            self.pose = (pose.position.x, pose.position.y, heading)

    def on_scan(self, message):
        with self.lock:
            self.scan = message

    def on_enable(self, request):
        """The drives work only while they are enabled."""
        self.enabled = request.data
        rospy.logdebug("drives %s", "enabled" if self.enabled else "disabled")
        return SetBoolResponse(success=True, message="enabled" if self.enabled else "disabled")

    def on_clearance(self, request):
        distance = self.clear_distance()
        return ClearanceResponse(known=distance is not None, distance=distance or 0.0)

    def clear_distance(self):
        """How far it is free in front; None without a recent scan."""
        with self.lock:
            scan = self.scan
        if scan is None or rospy.Time.now() - scan.header.stamp > self.scan_timeout:
            return None
        return clearance(scan, self.half_width)

    # -- what it does -------------------------------------------------------------------------------------------------

    def drive_to(self, goal):
        """Works at a goal until it is reached, given up, or cancelled."""
        target = (goal.target.x, goal.target.y)
        blocked_since = None
        rate = rospy.Rate(self.rate)
        while not rospy.is_shutdown():
            distance = self.distance_to(target)
            if self.server.is_preempt_requested():
                self.stop()
                self.server.set_preempted(DriveToResult(distance, "cancelled"))
                return
            if not self.enabled:
                self.stop()
                self.server.set_aborted(DriveToResult(distance, "disabled"))
                return
            if distance <= self.tolerance:
                self.stop()
                self.server.set_succeeded(DriveToResult(distance, ""))
                return
            blocked = self.go_on(target)
            if not blocked:
                blocked_since = None
            elif blocked_since is None:
                rospy.logwarn("somebody is in the way")
                blocked_since = rospy.Time.now()
            elif rospy.Time.now() - blocked_since > self.patience:
                self.stop()
                self.server.set_aborted(DriveToResult(distance, "blocked"))
                return
            self.server.publish_feedback(DriveToFeedback(distance, blocked))
            rate.sleep()

    def distance_to(self, target):
        """What is left; infinite before the first odometry."""
        with self.lock:
            pose = self.pose
        if pose is None:
            return float("inf")
        return math.hypot(target[0] - pose[0], target[1] - pose[1])

    def go_on(self, target):
        """The velocity for the next period; whether somebody is in the way."""
        with self.lock:
            pose = self.pose
        free = self.clear_distance()
        if pose is None or free is None:
            rospy.logwarn_throttle(1.0, "no odometry or no scan")
            self.stop()
            return True
        forward, turn = steer(pose, target, (self.max_speed, self.max_turn))
        allowed = allowed_speed(free, self.stop_distance, self.slow_distance, self.max_speed)
        twist = Twist()
        twist.linear.x = min(forward, allowed)
        twist.angular.z = turn
        self.cmd_vel.publish(twist)
        return forward > 0.0 and allowed == 0.0

    def stop(self):
        self.cmd_vel.publish(Twist())


if __name__ == "__main__":
    rospy.init_node("driver")
    Driver()
    rospy.spin()
