"""Programs of ROS 2: nodes and topics, over a harness."""

import unittest

from ros2_programs import SECOND, TRIED, Ros2Case
from system import System


class Nodes(Ros2Case):
    def test_a_talker(self):
        text = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", self.heard, 10)
        self.create_timer(0.5, self.tick)
        self.count = 0

    def tick(self):
        self.count += 1
        self.publisher.publish(String(data="hello %d" % self.count))
        self.get_logger().info("sent %d" % self.count)

    def heard(self, message):
        self.get_logger().info("heard " + message.data)
        if self.count == 2:
            raise SystemExit

rclpy.init()
node = Talker()
print(node.get_topic_names_and_types())
try:
    rclpy.spin(node)
except SystemExit:
    print("left")
node.destroy_node()
rclpy.shutdown()
print(rclpy.ok())
"""
        err = [
            "[INFO] [1735689600.500000000] [talker]: sent 1",
            "[INFO] [1735689600.500000000] [talker]: heard hello 1",
            "[INFO] [1735689601.000000000] [talker]: sent 2",
            "[INFO] [1735689601.000000000] [talker]: heard hello 2",
        ]
        out = [
            "[('/chatter', ['std_msgs/msg/String']), ('/parameter_events', ['rcl_interfaces/msg/ParameterEvent']), "
            "('/rosout', ['rcl_interfaces/msg/Log'])]",
            "left",
            "False",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)

    def test_names(self):
        text = TRIED + """
tried(lambda: Node("n"))
rclpy.init(args=[])
tried(lambda: Node("a b"))
tried(lambda: Node("n", namespace="1x"))
n = Node("n", namespace="x")
from std_msgs.msg import String
from std_srvs.srv import Trigger
tried(lambda: n.create_publisher(String, "a b", 1))
tried(lambda: n.create_service(Trigger, "7a", None))
tried(lambda: n.create_publisher(Trigger, "a", 1))
tried(lambda: n.create_publisher(int, "a", 1))
tried(lambda: n.create_publisher(String, "a", -1))
tried(lambda: n.create_publisher(String, "a", "x"))
p = n.create_publisher(String, "a", 1)
tried(lambda: p.publish("x"))
tried(lambda: p.publish(b"x"))
print(p.topic_name, p.topic, p.get_subscription_count(), n.count_publishers("a"), n.count_subscribers("/x/a"))
tried(lambda: n.get_publisher_names_and_types_by_node("n", "/x"))
tried(lambda: n.get_publisher_names_and_types_by_node("q", "/x"))
tried(lambda: n.get_service_names_and_types()[:2])
n.destroy_publisher(p)
tried(lambda: p.publish(String()))
"""
        out = [
            "NotInitializedException: ('rclpy.init() has not been called', 'cannot create node')",
            "InvalidNodeNameException: Invalid node name: node name must not contain characters other than "
            "alphanumerics or '_':",
            "  'a b'",
            "    ^",
            "InvalidNamespaceException: Invalid namespace: namespace must not have a token that starts with a number:",
            "  '/1x'",
            "    ^",
            "InvalidTopicNameException: Invalid topic name: topic name must not contain characters other than "
            "alphanumerics, '_', '~', '{', or '}':",
            "  'a b'",
            "    ^",
            "InvalidServiceNameException: Invalid service name: topic name token must not start with a number:",
            "  '7a'",
            "   ^",
            "RuntimeError: The message type provided is not valid (<class 'std_srvs.srv._trigger.Trigger'>), this "
            "might be a service or action",
            "AttributeError: type object 'int' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type "
            "but it should be a ROS 2 message type. Make sure to source your ROS 2 workspace after your ROS 1 "
            "workspace.",
            "ValueError: history depth must be greater than or equal to zero",
            "TypeError: Expected QoSProfile or int, but received <class 'str'>",
            "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'str'>",
            "NotImplementedError: publishing a serialized message is not supported by hrdsl's rclpy: publish an "
            "object of the message's class",
            "/x/a a 0 1 0",
            "[('/x/a', ['std_msgs/msg/String'])]",
            "NodeNameNonExistentError: Cannot get publisher names and types for nonexistent node: node name: q, node "
            "namespace: /x",
            "[('/x/n/describe_parameters', ['rcl_interfaces/srv/DescribeParameters']), ('/x/n/get_parameter_types', "
            "['rcl_interfaces/srv/GetParameterTypes'])]",
            "InvalidHandle: cannot use Destroyable because destruction was requested",
        ]
        self.assertEqual(self.said(text), out)

    def test_smaller_things(self):
        text = TRIED + """
import os, tempfile
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity, get_logger, set_logger_level
from rclpy.parameter import parameter_dict_from_yaml_file
from rclpy.qos import DurabilityPolicy, QoSPresetProfiles, ReliabilityPolicy
from rclpy.time import Time
rclpy.init()
n = Node("n", namespace="left/arm")
print(n.get_name(), n.get_namespace(), n.get_fully_qualified_name())
executor = SingleThreadedExecutor()
print(executor.add_node(n), executor.get_nodes() == [n], executor.add_node(n))
executor.remove_node(n)
print(executor.get_nodes())
profile = QoSPresetProfiles.SENSOR_DATA.value
print(profile.reliability is ReliabilityPolicy.BEST_EFFORT, profile.durability is DurabilityPolicy.VOLATILE, profile.depth)
clock = n.get_clock()
begin = clock.now()
print(clock.sleep_until(begin + rclpy.duration.Duration(seconds=1.5)), (clock.now() - begin).nanoseconds)
print(Time.from_msg(clock.now().to_msg()) == clock.now())
set_logger_level("quiet", LoggingSeverity.ERROR)
get_logger("quiet").warning("nobody reads this")
print(get_logger("quiet").get_effective_level().name)
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "p.yaml")
    with open(path, "w") as file:
        file.write("/**: {ros__parameters: {a: 1}}\\nn: {ros__parameters: {b: {c: x}}}\\nodd: 3\\n")
    for how in ({}, {"use_wildcard": True, "target_nodes": ["/n"]}, {"target_nodes": ["n"], "namespace": "ns"}, {"target_nodes": ["odd"]}):
        tried(lambda: sorted((name, value.value.type) for name, value in parameter_dict_from_yaml_file(path, **how).items()))
"""
        out = [
            "n /left/arm /left/arm/n",
            "True True False",
            "[]",
            "True True 5",
            "True 1500000000",
            "True",
            "ERROR",
            "RuntimeError: YAML file is not a valid ROS parameter file for node odd",
            "[('a', 2), ('b.c', 4)]",
            "[('ns.b.c', 4)]",
            "RuntimeError: YAML file is not a valid ROS parameter file for node odd",
        ]
        self.assertEqual(self.said(text), out)

    def test_what_is_refused(self):
        text = TRIED + """
rclpy.init()
n = Node("n")
from std_msgs.msg import String
tried(lambda: n.create_subscription(String, "a", print, 1, raw=True))
tried(lambda: __import__("rclpy.lifecycle"))
tried(lambda: n.handle)
"""
        out = [
            "NotImplementedError: a raw subscription is not supported by hrdsl's rclpy: messages are no bytes here; "
            "subscribe without `raw`",
            "NotImplementedError: rclpy.lifecycle is not supported by hrdsl's rclpy: use rclpy.node.Node, and do in "
            "its constructor what on_configure and on_activate do",
            "NotImplementedError: Node.handle is not supported by hrdsl's rclpy: use the methods of the node",
        ]
        self.assertEqual(self.said(text), out)

    def test_what_is_refused_at_its_use(self):
        text = TRIED + """
import launch, launch_ros.actions, ros2cli.node.strategy, ros2topic.api
from launch.launch_description_sources import PythonLaunchDescriptionSource
from typing import List, Optional

def generate_launch_description(more: Optional[List[launch_ros.actions.Node]] = None) -> launch.LaunchDescription:
    return launch.LaunchDescription([launch_ros.actions.Node(package="a", executable="b")])

class Own(launch.actions.Action):
    pass

tried(generate_launch_description)
tried(lambda: PythonLaunchDescriptionSource("a"))
tried(lambda: launch.substitutions.LaunchConfiguration("a"))
tried(Own)
tried(lambda: ros2topic.api.get_topic_names_and_types(node=None))
tried(lambda: ros2cli.node.strategy.NodeStrategy([]))
tried(lambda: launch.actions)
tried(lambda: launch.LaunchService)
tried(lambda: (hasattr(launch, "__all__"), hasattr(launch.LaunchService, "__doc__")))
"""
        refused = "NotImplementedError: %s is not supported by hrdsl's rclpy: %s"
        programs = "name the programs of the system in the scenario, with their arguments"
        out = [
            refused % ("launch_ros.actions.Node", programs),
            refused % ("launch.launch_description_sources.PythonLaunchDescriptionSource", programs),
            refused % ("launch.substitutions.LaunchConfiguration", programs),
            refused % ("launch.actions.Action", programs),
            refused % ("ros2topic.api.get_topic_names_and_types", "ask the node for topics and their types"),
            refused % ("ros2cli.node.strategy.NodeStrategy", "ask the node for topics and services"),
            "<module 'launch.actions'>",
            "<launch.LaunchService, which is refused>",
            "(False, True)",
        ]
        self.assertEqual(self.said(text), out)

    def test_packages(self):
        text = TRIED + """
from ament_index_python.packages import get_package_prefix, get_package_share_directory
tried(lambda: get_package_share_directory("mine"))
tried(lambda: get_package_prefix("mine"))
tried(lambda: get_package_share_directory("none"))
"""
        out = [
            "/ws/install/mine/share/mine",
            "/ws/install/mine",
            "PackageNotFoundError: \"package 'none' not found, searching: [the packages of the scenario's workspace: "
            "mine]\"",
        ]
        self.assertEqual(self.said(text, packages={"mine": "/ws/install/mine/share/mine"}), out)

    def test_init_and_shutdown(self):
        text = TRIED + """
import threading, time
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
rclpy.init()
n = Node("n")
n.create_timer(1.0, lambda: (print("bye"), rclpy.shutdown()))
rclpy.spin(n)
print("spun", rclpy.ok())
rclpy.init()
n = Node("m")
executor = SingleThreadedExecutor()
executor.add_node(n)
threading.Timer(1.0, rclpy.shutdown).start()
tried(executor.spin)
tried(rclpy.shutdown)
rclpy.try_shutdown()
with rclpy.init() as context:
    tried(rclpy.init)
    with Node("w") as w:
        print(w.get_fully_qualified_name(), rclpy.ok())
print(rclpy.ok())
"""
        out = [
            "bye",
            "spun False",
            "ExternalShutdownException: ",
            "RuntimeError: Context must be initialized before it can be shutdown",
            "RuntimeError: Context.init() must only be called once",
            "/w True",
            "False",
        ]
        self.assertEqual(self.said(text), out)


class Topics(Ros2Case):
    def test_depth_and_latching(self):
        text = TRIED + """
from rclpy.qos import *
from std_msgs.msg import String
rclpy.init()
n = Node("n")
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
p = n.create_publisher(String, "map", latched)
p.publish(String(data="one")); p.publish(String(data="two"))
n.create_subscription(String, "map", lambda m: print("late", m.data), latched)
n.create_subscription(String, "queue", lambda m: print("queued", m.data), 2)
q = n.create_publisher(String, "queue", 10)
for text in "abcd":
    q.publish(String(data=text))
for _ in range(3):
    rclpy.spin_once(n)
tried(lambda: QoSProfile()); tried(lambda: QoSProfile(history=HistoryPolicy.KEEP_LAST)); tried(lambda: QoSProfile(depht=1))
print(qos_check_compatible(qos_profile_sensor_data, QoSProfile(depth=1)))
"""
        out = [
            "late two",
            "queued c",
            "queued d",
            "InvalidQoSProfileException: ('Invalid QoSProfile', 'History and/or depth settings are required.')",
            "InvalidQoSProfileException: ('Invalid QoSProfile', 'History set to KEEP_LAST without a depth setting.')",
            "AssertionError: Invalid arguments passed to constructor: dict_keys(['depht'])",
            "(<QoSCompatibility.ERROR: 2>, 'ERROR: Best effort publisher and reliable subscription;')",
        ]
        self.assertEqual(self.said(text), out)

    def test_profiles_that_do_not_fit(self):
        text = TRIED + """
from rclpy.qos import *
from rclpy.qos_event import SubscriptionEventCallbacks
from std_msgs.msg import String
rclpy.init()
n = Node("n")
n.create_subscription(String, "scan", print, 10)
publisher = n.create_publisher(String, "scan", qos_profile_sensor_data)
told = SubscriptionEventCallbacks(incompatible_qos=lambda event: print("told", event.last_policy_kind.name))
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
n.create_publisher(String, "map", 10)
n.create_subscription(String, "map", print, latched, event_callbacks=told)
print("made")
publisher.publish(String(data="lost"))
publisher.publish(String(data="lost"))
for _ in range(6):
    rclpy.spin_once(n, timeout_sec=0.01)
publisher.destroy()
rclpy.spin_once(n, timeout_sec=0.01)
"""
        err = [
            "[WARN] [1735689600.000000000] [n]: New subscription discovered on topic 'scan', requesting incompatible "
            "QoS. No messages will be sent to it. Last incompatible policy: RELIABILITY",
            "[WARN] [1735689600.000000000] [n]: New publisher discovered on topic 'scan', offering incompatible QoS. "
            "No messages will be received from it. Last incompatible policy: RELIABILITY",
            "[WARN] [1735689600.000000000] [n]: New subscription discovered on topic 'map', requesting incompatible "
            "QoS. No messages will be sent to it. Last incompatible policy: DURABILITY",
        ]
        out = [
            "made",
            "told DURABILITY",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)

    def test_late_subscriptions_get_what_was_published_if_they_ask_for_it(self):
        text = TRIED + """
from rclpy.qos import *
from std_msgs.msg import String
rclpy.init()
n = Node("n")
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
n.create_publisher(String, "map", latched).publish(String(data="old"))
n.create_subscription(String, "map", lambda m: print("volatile", m.data), 10)
n.create_subscription(String, "map", lambda m: print("latched", m.data), latched)
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
"""
        self.assertEqual(self.said(text), ["latched old"])

    def test_waiting_for_a_message(self):
        text = TRIED + """
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import String
rclpy.init()
n = Node("n")
print(wait_for_message(String, n, "out", time_to_wait=2.0), wait_for_message(String, n, "out", time_to_wait=1.0))
print(n.get_clock().now())
"""
        system = System([(SECOND, {"topic": "/out", "message": {"data": "hello"}})])
        out = [
            "(True, std_msgs.msg.String(data='hello')) (False, None)",
            "Time(nanoseconds=1735689602000000000, clock_type=ROS_TIME)",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_loops_that_only_look(self):
        text = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int8
rclpy.init()
n = Node("n")
got = []
n.create_subscription(Int8, "x", got.append, 1)
while rclpy.ok() and not got:
    rclpy.spin_once(n, timeout_sec=0)
print(got, n.get_clock().now().seconds_nanoseconds())
got.clear()
while rclpy.ok() and not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got, n.get_clock().now().seconds_nanoseconds())
for _ in range(3000):  # the first 1000 let others run
    rclpy.spin_once(n, timeout_sec=0)
print(n.get_clock().now().seconds_nanoseconds())
"""
        system = System([(at, {"topic": "/x", "message": {"data": 1}}) for at in (SECOND // 100, 3 * SECOND)])
        out = [
            "[std_msgs.msg.Int8(data=1)] (1735689600, 11000000)",
            "[std_msgs.msg.Int8(data=1)] (1735689603, 0)",
            "(1735689603, 2000000)",
        ]
        self.assertEqual(self.said(text, system), out)


if __name__ == "__main__":
    unittest.main()
