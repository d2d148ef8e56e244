#!/usr/bin/env python3
"""Tells whether the laser sees anything too near.

    rosrun care_robot collision_sensor.py

Hears      /scan (sensor_msgs/LaserScan)
Publishes  /collision (std_msgs/Bool)
"""

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

TOO_NEAR = 0.2  # m
PERIOD = 0.75  # s


def watch():
    collision = rospy.Publisher("/collision", Bool, queue_size=1)
    while not rospy.is_shutdown():
        scan = rospy.wait_for_message("/scan", LaserScan)
        collision.publish(min(scan.ranges) < TOO_NEAR)
        rospy.sleep(PERIOD)


if __name__ == "__main__":
    rospy.init_node("collision_sensor")
    try:
        watch()
    except rospy.ROSInterruptException:
        pass
