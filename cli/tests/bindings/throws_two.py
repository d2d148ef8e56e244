import rclpy
from rclpy.node import Node
from std_msgs.msg import Int8


def order(message):
    print("order", message.data)
    raise ValueError("no such table")


rclpy.init()
node = Node("brain")
node.create_subscription(Int8, "/orders", order, 1)
rclpy.spin(node)
