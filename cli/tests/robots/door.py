"""Drives through the door: it steers to the middle of the widest gap that it sees ahead."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.drive = self.create_publisher(Twist, "/cmd_vel", 10)
        self.arrived = self.create_publisher(Empty, "/arrived", 10)
        self.create_subscription(LaserScan, "/scan", self.scan, 10)
        self.create_subscription(Odometry, "/odom", self.odom, 10)
        self.x = 0.0
        self.heading = 0.0
        self.done = False

    def odom(self, msg):
        assert msg.child_frame_id == "base_footprint", msg.child_frame_id
        self.x = msg.pose.pose.position.x
        self.heading = 2 * math.atan2(msg.pose.pose.orientation.z, msg.pose.pose.orientation.w)

    def scan(self, msg):
        assert msg.header.frame_id == "laser_link" and len(msg.ranges) == 181
        twist = Twist()
        if self.x > 3.1:
            if not self.done:
                self.arrived.publish(Empty())
            self.done = True
        else:
            twist.linear.x = 0.3
            twist.angular.z = 1.5 * self.bearing(msg) if self.x < 1.9 else -1.5 * self.heading
        self.drive.publish(twist)

    def bearing(self, msg):
        """Where the farthest beams within 60 degrees are, on average."""
        ahead = []
        for i, distance in enumerate(msg.ranges):
            angle = msg.angle_min + i * msg.angle_increment
            if abs(angle) < 1.0 and math.isfinite(distance):
                ahead.append((distance, angle))
        most = max(distance for distance, _ in ahead)
        far = [angle for distance, angle in ahead if distance > 0.8 * most]
        return sum(far) / len(far)


def main():
    rclpy.init()
    rclpy.spin(Door())


if __name__ == "__main__":
    main()
