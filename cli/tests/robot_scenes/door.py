"""Drives through the opening of the wall ahead that the laser sees, and says how well the base followed."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, String

WALL = 2.95  # m, the face of the wall that the door is in
WIDTH = 1.2  # m, what the robot needs
BEHIND = 4.2  # m, where it stops
SPEED = 0.4  # m/s
# The laser hangs upside down at the front right corner, and looks outward.
LASER = (0.27512, -0.18297)
YAW = -math.pi / 4
PATIENCE = 50  # scans


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.blind = self.declare_parameter("blind", False).value
        self.drive = self.create_publisher(Twist, "/cmd_vel", 10)
        self.outcome = self.create_publisher(String, "/outcome", 10)
        self.create_subscription(Bool, "/call", self.on_call, 10)
        self.create_subscription(LaserScan, "/scan", self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Odometry, "/odom", self.on_odom, qos_profile_sensor_data)
        self.called = self.ended = False
        self.pose = None
        self.middle = None
        self.looked = 0
        self.command, self.since = (0.0, 0.0, 0.0), self.get_clock().now()
        self.worst = self.settled = 0.0

    def on_call(self, msg):
        self.called = self.called or msg.data

    def on_odom(self, msg):
        turn = msg.pose.pose.orientation
        self.pose = (msg.pose.pose.position.x, msg.pose.pose.position.y, 2 * math.atan2(turn.z, turn.w))
        twist = msg.twist.twist
        measured = (twist.linear.x, twist.linear.y)
        error = math.dist(measured, self.command[:2])
        self.worst = max(self.worst, error)
        if (self.get_clock().now() - self.since).nanoseconds > 1e9:
            self.settled = max(self.settled, error)

    def on_scan(self, msg):
        if not self.called or self.pose is None or self.ended:
            return
        x, y, heading = self.pose
        if self.blind:
            self.looked += 1
            self.go(SPEED, 0.0, 0.0)
            if self.looked > 2 * PATIENCE:
                self.end("arrived")
            return
        if x < WALL - 1.0:
            self.look(msg)
        if self.middle is None:
            self.looked += 1
            if self.looked > PATIENCE:
                self.end("gave up")
            return
        aside = self.middle - y
        if x > BEHIND:
            self.end("arrived")
        elif x < WALL - 1.0 or abs(aside) < 0.05:
            self.go(SPEED, max(-SPEED, min(SPEED, aside)), -heading)
        else:
            self.go(0.0, max(-SPEED, min(SPEED, aside)), -heading)

    def look(self, msg):
        """Finds the widest opening of the wall, from where beams go through it."""
        x, y, heading = self.pose
        cos, sin = math.cos(heading), math.sin(heading)
        at = (x + cos * LASER[0] - sin * LASER[1], y + sin * LASER[0] + cos * LASER[1])
        free, hit = [], []
        for number, distance in enumerate(msg.ranges):
            angle = heading + YAW - (msg.angle_min + number * msg.angle_increment)
            ahead = math.cos(angle)
            if ahead < 0.2:
                continue
            to_wall = (WALL - at[0]) / ahead
            side = at[1] + to_wall * math.sin(angle)
            (free if distance > to_wall + 0.4 else hit).append(side)
        openings = []
        edges = sorted(hit)
        for low, high in zip(edges, edges[1:]):
            if high - low > WIDTH and any(low < side < high for side in free):
                openings.append((high - low, (low + high) / 2))
        self.middle = max(openings)[1] if openings else None

    def go(self, forward, left, turn):
        command = (forward, left, turn)
        if math.dist(command, self.command) > 0.01:
            self.since = self.get_clock().now()
        self.command = command
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = command
        self.drive.publish(twist)

    def end(self, outcome):
        self.go(0.0, 0.0, 0.0)
        self.ended = True
        self.outcome.publish(String(data=outcome))
        print("tracking error: at most %.4f m/s, a second after a command %.5f m/s" % (self.worst, self.settled))


def main():
    rclpy.init()
    rclpy.spin(Door())


if __name__ == "__main__":
    main()
