"""Programs of ROS 2: timers, executors and logs, over a harness."""

import unittest

from ros2_programs import SECOND, TRIED, Ros2Case
from system import System


class Schedules(Ros2Case):
    text = """
import rclpy
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("node")
said = []
for name in "abc":
    node.create_timer(1.0, lambda name=name: said.append(name))
publisher = node.create_publisher(String, "topic", 10)
node.create_subscription(String, "topic", lambda message: said.append(message.data), 10)
executor = EXECUTOR()
executor.add_node(node)
for name in "xyz":
    executor.create_task(said.append, name)
for data in "123":
    publisher.publish(String(data=data))
done = rclpy.task.Future()
node.create_timer(1.5, lambda: done.set_result(None))
executor.spin_until_future_complete(done)
print("".join(said))
"""

    def test_what_is_ready_at_once_runs_in_an_order_that_is_drawn(self):
        for executor, first in ("SingleThreadedExecutor", "zyx123abc"), ("MultiThreadedExecutor", "zyx123acb"):
            text = self.text.replace("EXECUTOR", executor)
            self.assertEqual(self.said(text), [first])
            found = set()
            for seed in range(1, 7):
                (order,) = self.said(text, env={"HRDSL_SCHEDULE": str(seed)})
                self.assertEqual([order], self.said(text, env={"HRDSL_SCHEDULE": str(seed)}), "the same seed, the same order")
                self.assertEqual(sorted(order), sorted(first))
                found.add(order)
                if executor.startswith("Single"):
                    self.assertEqual([each for each in order if each in "123"], list("123"), "of one topic, as published")
            self.assertGreater(len({"".join(each for each in order if each in "abc") for order in found}), 2, found)
            self.assertGreater(len({"".join(each for each in order if each in "xyz") for order in found}), 2, found)


class Timers(Ros2Case):
    def test_the_grid(self):
        text = """
import rclpy, time
from rclpy.node import Node
rclpy.init()
n = Node("n")
calls = []

def now():
    return n.get_clock().now().nanoseconds / 1e9 - 1735689600

def slow():
    calls.append(1)
    print("slow", now(), t.time_until_next_call())
    time.sleep({1: 2.5, 2: 2.0}.get(len(calls), 0))
    if len(calls) == 5:
        t.cancel()
        print("canceled", t.is_canceled())

t = n.create_timer(1.0, slow)
n.create_timer(4.0, lambda: print("four", now()))
once = n.create_timer(9.0, lambda: (once.cancel(), t.reset(), print("reset", now())))
zero = n.create_timer(0.0, lambda: (print("zero", now()), zero.cancel()))
for i in range(11):
    rclpy.spin_once(n, timeout_sec=3.0)
print(now())
t.cancel()
rclpy.spin_once(n, timeout_sec=0.5)
print(now())
rclpy.spin_once(n, timeout_sec=0)
print(now())
"""
        out = [
            "zero 0.0",
            "slow 1.0 1000000000",
            "slow 3.5 500000000",
            "slow 5.5 500000000",
            "four 5.5",
            "slow 6.0 1000000000",
            "slow 7.0 1000000000",
            "canceled True",
            "four 8.0",
            "reset 9.0",
            "slow 10.0 1000000000",
            "slow 11.0 1000000000",
            "11.0",
            "11.5",
            "11.5",
        ]
        self.assertEqual(self.said(text), out)

    def test_rates_and_sleeps(self):
        text = TRIED + """
import threading, time
from rclpy.duration import Duration
from rclpy.clock import Clock, ClockType
rclpy.init()
n = rclpy.create_node("r", namespace="ns")
rate = n.create_rate(2)
thread = threading.Thread(target=rclpy.spin, args=(n,), daemon=True)
thread.start()
for _ in range(3):
    rate.sleep()
    print(time.monotonic())
print(n.get_clock().sleep_for(Duration(seconds=0.25)), time.monotonic(), n.get_clock().now())
steady = Clock(clock_type=ClockType.STEADY_TIME)
print(steady, steady.now(), Clock().now())
tried(lambda: n.get_clock().now() - steady.now())
print(n.get_clock().now() - Clock(clock_type=ClockType.ROS_TIME).now(), n.get_clock().now().to_msg())
n.destroy_node()
"""
        out = [
            "0.5",
            "1.0",
            "1.5",
            "True 1.75 Time(nanoseconds=1735689601750000000, clock_type=ROS_TIME)",
            "Clock(clock_type=STEADY_TIME) Time(nanoseconds=1750000000, clock_type=STEADY_TIME) "
            "Time(nanoseconds=1735689601750000000, clock_type=SYSTEM_TIME)",
            "TypeError: Can't subtract times with different clock types",
            "0 nanoseconds builtin_interfaces.msg.Time(sec=1735689601, nanosec=750000000)",
        ]
        self.assertEqual(self.said(text), out)

    def test_time_of_a_simulator(self):
        text = TRIED + """
rclpy.init(args=["--ros-args", "-p", "use_sim_time:=true"])
n = Node("n")
import time
from rclpy.clock import JumpThreshold
clock = n.get_clock()
told = lambda jump: print(jump.clock_change.name, jump.delta.nanoseconds)
clock.create_jump_callback(JumpThreshold(min_forward=None, min_backward=None), post_callback=told)
print(clock.now().nanoseconds - time.time_ns(), clock.ros_time_is_active)
n.create_timer(1.5, lambda: print(clock.now()))
rclpy.spin_once(n)
n.set_parameters([Parameter("use_sim_time", value=False)])
print(clock.now(), clock.ros_time_is_active)
"""
        out = [
            "0 True",
            "Time(nanoseconds=1735689601500000000, clock_type=ROS_TIME)",
            "ROS_TIME_DEACTIVATED 0",
            "Time(nanoseconds=1735689601500000000, clock_type=ROS_TIME) False",
        ]
        self.assertEqual(self.said(text), out)


class Executors(Ros2Case):
    def test_order(self):
        text = """
import rclpy, time
from rclpy.node import Node
from std_msgs.msg import Int8
from std_srvs.srv import Trigger
rclpy.init()
n = Node("n", start_parameter_services=False)
p = n.create_publisher(Int8, "a", 10)
n.create_service(Trigger, "t", lambda q, r: (print("service"), r)[1])
c = n.create_client(Trigger, "t")
g = n.create_guard_condition(lambda: print("guard"))
n.create_subscription(Int8, "a", lambda m: print("first", m.data), 10)
n.create_subscription(Int8, "a", lambda m: print("second", m.data), 1)
n.create_timer(1.0, lambda: print("timer one"))
n.create_timer(1.0, lambda: print("timer two"))
p.publish(Int8(data=1))
p.publish(Int8(data=2))
g.trigger()
c.call_async(Trigger.Request()).add_done_callback(lambda f: print("answered"))
time.sleep(1)
rclpy.spin(n)
"""
        system = System(end=3 * SECOND // 2)
        out = [
            "timer one",
            "timer two",
            "first 1",
            "second 2",
            "guard",
            "service",
            "first 2",
            "answered",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_callbacks_that_wait(self):
        text = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
rclpy.init()
n = Node("n")
client = n.create_client(Trigger, "t", callback_group=MutuallyExclusiveCallbackGroup())

async def serve(request, response):
    response.success, response.message = True, "yes"
    return response

async def tick():
    print("tick", n.get_clock().now().seconds_nanoseconds())
    response = await client.call_async(Trigger.Request())
    print("got", response.message)

async def heard(message):
    print("heard", message.data)

n.create_service(Trigger, "t", serve, callback_group=ReentrantCallbackGroup())
n.create_timer(1.0, tick)
n.create_subscription(String, "x", heard, 10)
n.create_publisher(String, "x", 10).publish(String(data="a"))
rclpy.spin(n)
"""
        system = System(end=5 * SECOND // 2)
        out = [
            "heard a",
            "tick (1735689601, 0)",
            "got yes",
            "tick (1735689602, 0)",
            "got yes",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_threads(self):
        text = """
import rclpy, threading, time
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
rclpy.init()
n = Node("n")
same, free = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()

def slowly(name):
    print("%.1f" % time.monotonic(), name, "begins in", threading.current_thread().name)
    time.sleep(1.5)
    print("%.1f" % time.monotonic(), name, "ends")

n.create_timer(1.0, lambda: slowly("a"), callback_group=same)
n.create_timer(1.0, lambda: slowly("b"), callback_group=same)
n.create_timer(1.0, lambda: slowly("c"), callback_group=free)
executor = MultiThreadedExecutor(num_threads=3)
executor.add_node(n)
executor.spin()
"""
        system = System(end=4 * SECOND)
        out = [
            "1.0 a begins in ThreadPoolExecutor-0_0",
            "1.0 c begins in ThreadPoolExecutor-0_1",
            "2.0 c begins in ThreadPoolExecutor-0_2",
            "2.5 a ends",
            "2.5 c ends",
            "2.5 a begins in ThreadPoolExecutor-0_0",
            "3.0 c begins in ThreadPoolExecutor-0_1",
            "3.5 c ends",
            "4.0 a ends",
            "4.0 a begins in ThreadPoolExecutor-0_2",
            "4.0 c begins in ThreadPoolExecutor-0_0",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_tasks_and_futures(self):
        text = TRIED + """
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
rclpy.init()
n = Node("n")
executor = SingleThreadedExecutor()
executor.add_node(n)
future = Future()
n.create_timer(2.0, lambda: future.done() or future.set_result("ready"))

async def wait():
    print("waits")
    return await future + "!"

task = executor.create_task(wait)
task.add_done_callback(lambda t: print("done", t.result()))
executor.spin_until_future_complete(task, timeout_sec=1.0)
print(task.done(), n.get_clock().now().seconds_nanoseconds()[0])
executor.spin_until_future_complete(task)
print(task.result(), n.get_clock().now().seconds_nanoseconds()[0])
for _ in range(3):
    executor.spin_once(timeout_sec=0)
print(executor.create_task(lambda x: x + 1, 2).done())
bad = executor.create_task(lambda: 1 / 0)
tried(lambda: executor.spin_once())
tried(lambda: executor.spin_once())
print(executor.get_nodes() == [n], executor.add_node(n), executor.shutdown())
"""
        out = [
            "waits",
            "False 1735689601",
            "ready! 1735689602",
            "done ready!",
            "False",
            "ZeroDivisionError: division by zero",
            "None",
            "True False True",
        ]
        self.assertEqual(self.said(text), out)

    def test_futures_in_a_loop_of_asyncio(self):
        text = """
import asyncio, threading, time
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.client = self.create_client(Trigger, "far")
        self.create_timer(0.25, self.tick, callback_group=ReentrantCallbackGroup())
        self.ticks = 0
    async def tick(self):  # a coroutine of the executor, while a loop of asyncio runs around it
        answer = await self.client.call_async(Trigger.Request())
        self.ticks += 1
        if self.ticks < 3:
            print("tick", answer.message, round(time.monotonic(), 2))
    async def ask(self, name):
        answer = await self.client.call_async(Trigger.Request())
        print(name, answer.message)
        return name

async def spinning(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.01)
        await asyncio.sleep(0.001)

async def run():
    rclpy.init()
    node = Asker()
    spin = asyncio.get_running_loop().create_task(spinning(node))
    print(await asyncio.gather(node.ask("one"), node.ask("two")))
    later = Future()
    threading.Thread(target=lambda: (time.sleep(0.7), later.set_result(7))).start()
    print(await later, round(time.monotonic(), 1), await later)
    try:
        await asyncio.wait_for(Future(), 0.5)
    except asyncio.TimeoutError:
        print("timed out", round(time.monotonic(), 1))
    failed = Future()
    failed.set_exception(ValueError("no"))
    try:
        await failed
    except ValueError as error:
        print(repr(error))
    spin.cancel()

asyncio.run(run())
"""
        system = System(services={"/far": lambda message: {"success": True, "message": "yes"}}, end=100 * SECOND)
        out = [
            "one yes",
            "two yes",
            "['one', 'two']",
            "tick yes 0.25",
            "tick yes 0.5",
            "7 0.7 7",
            "timed out 1.2",
            "ValueError('no')",
        ]
        self.assertEqual(self.said(text, system=system), out)

    def test_errors_leave_spin(self):
        text = TRIED + """
rclpy.init()
n = Node("n")

def bad():
    raise ValueError("bad")

n.create_timer(1.0, bad)
tried(lambda: rclpy.spin(n))
n.create_timer(0.25, lambda: print("goes on"))
tried(lambda: rclpy.spin_once(n))
from std_msgs.msg import Int8
n.create_subscription(Int8, "x", print, 1)
tried(lambda: rclpy.spin(n))
"""
        system = System([(3 * SECOND // 2, {"topic": "/x", "message": {"wrong": 1}})])
        out = [
            "ValueError: bad",
            "goes on",
            "None",
            "goes on",
            "ProtocolError: topic /x (std_msgs/msg/Int8): what has arrived does not fit its type: KeyError('data')",
        ]
        self.assertEqual(self.said(text, system), out)


class Logs(Ros2Case):
    def test_levels_and_options(self):
        text = TRIED + """
import time
rclpy.init()
l = Node("n").get_logger()
for i in range(4):
    l.info("once %d" % i, once=True)
    l.warning("skip %d" % i, skip_first=True)
    l.error("throttle %d" % i, throttle_duration_sec=1.0)
    l.debug("no")
    time.sleep(0.4)
l.set_level(rclpy.logging.LoggingSeverity.DEBUG)
l.debug("yes"); l.fatal("f"); l.warn("w")
tried(lambda: l.info(3)); tried(lambda: l.info("x", other=1)); tried(lambda: l.get_child(""))
l.get_child("c").info("child")
print(l.get_effective_level().name, l.is_enabled_for(10))
Node("n", namespace="/a/b").get_logger().info("deep")
"""
        err = [
            "[INFO] [1735689600.000000000] [n]: once 0",
            "[ERROR] [1735689600.000000000] [n]: throttle 0",
            "[WARN] [1735689600.400000000] [n]: skip 1",
            "[WARN] [1735689600.800000000] [n]: skip 2",
            "[WARN] [1735689601.200000000] [n]: skip 3",
            "[ERROR] [1735689601.200000000] [n]: throttle 3",
            "[DEBUG] [1735689601.600000000] [n]: yes",
            "[FATAL] [1735689601.600000000] [n]: f",
            "[WARN] [1735689601.600000000] [n]: w",
            "[INFO] [1735689601.600000000] [n.c]: child",
            "[INFO] [1735689601.600000000] [a.b.n]: deep",
        ]
        out = [
            "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments: the message must be a str, not "
            "'int'",
            "TypeError: parameter \"other\" is not one of the recognized logging options \"['throttle_duration_sec', "
            "'throttle_time_source_type', 'skip_first', 'once']\"",
            "ValueError: Child logger name must not be empty.",
            "DEBUG True",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)

    def test_other_forms(self):
        text = TRIED + """
rclpy.init()
n = Node("n")
n.get_logger().warn("two\\nlines")
"""
        env = {
            "RCUTILS_CONSOLE_OUTPUT_FORMAT": "{severity} {name} {function_name} {x} {message}",
            "RCUTILS_COLORIZED_OUTPUT": "1",
        }
        err = [
            "[33mWARN n <module> {x} two",
            "lines[0m",
        ]
        out = []
        self.assertEqual(self.said(text, env=env, err="\n".join(err) + "\n"), out)


if __name__ == "__main__":
    unittest.main()
