"""The node that looks ahead: it says when somebody comes or goes, and answers who asks."""

import math
import threading

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

from corridor_interfaces.srv import Look

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SCAN_TIMEOUT = 0.5  # seconds


class Lookout(Node):
    def __init__(self):
        super().__init__("lookout")
        self.reach = self.declare_parameter("reach", 0.5).value
        self.half_angle = math.radians(self.declare_parameter("view_angle", 60.0).value) / 2
        self.nearest = math.inf
        self.scans = 0
        self.scanned = threading.Condition()
        self.someone = None
        self.someone_publisher = self.create_publisher(Bool, "~/someone", LATCHED)
        # `look` waits for the next scan, so that the two must not exclude each other.
        self.create_service(Look, "~/look", self.look, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_subscription(
            LaserScan,
            "scan",
            self.on_scan,
            qos_profile_sensor_data,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def on_scan(self, scan):
        with self.scanned:
            self.nearest = self.nearest_ahead(scan)
            self.scans += 1
            self.scanned.notify_all()
        someone = self.nearest < self.reach
        if someone != self.someone:
            self.someone = someone
            self.get_logger().info("somebody is %.2f m ahead" % self.nearest if someone else "the way is free")
            self.someone_publisher.publish(Bool(data=someone))

    def nearest_ahead(self, scan):
        """The scanner looks all around, straight ahead first. What is too near to be measured is as near as can be."""
        beams = round(self.half_angle / scan.angle_increment)
        return max(min(scan.ranges[-beams:] + scan.ranges[: beams + 1]), scan.range_min)

    def look(self, request, response):
        """Waits for the next scan: what was seen before somebody asked is old."""
        with self.scanned:
            before = self.scans
            is_seen = self.scanned.wait_for(lambda: self.scans > before, timeout=SCAN_TIMEOUT)
            response.is_free = is_seen and self.nearest >= self.reach
            response.nearest = self.nearest
        return response
