"""Services and actions of ROS 2, over a harness."""

import unittest

from ros2_programs import SECOND, TRIED, Ros2Case, run_ros2
from system import System


def world(goal):
    """Counts up, a number in each second."""
    order = goal["order"]
    if order < 0:
        return [(0, "rejected", {"sequence": []})]
    end = "aborted" if order == 5 else "succeeded"
    return [(SECOND, {"sequence": [0]}), (order * SECOND, end, {"sequence": list(range(order))})]


class Services(Ros2Case):
    def test_calls(self):
        text = TRIED + """
import threading, time
from example_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
rclpy.init()
s, c = Node("server"), Node("client")

def add(request, response):
    print("add", request)
    response.sum = request.a + request.b
    return response

s.create_service(AddTwoInts, "add", add)
client = c.create_client(AddTwoInts, "add")
print(client.wait_for_service(timeout_sec=1.0), client.service_is_ready())
executor = SingleThreadedExecutor()
executor.add_node(s)
executor.add_node(c)
future = client.call_async(AddTwoInts.Request(a=1, b=2))
executor.spin_until_future_complete(future)
print(future.result(), future.done())
tried(lambda: client.call_async(3))
thread = threading.Thread(target=executor.spin, daemon=True)
thread.start()
print(client.call(AddTwoInts.Request(a=5, b=6)).sum)

async def later():
    return (await client.call_async(AddTwoInts.Request(a=7, b=8))).sum

task = executor.create_task(later)
time.sleep(1)
print(task.done(), task.result())
none = c.create_client(AddTwoInts, "other")
print(none.wait_for_service(timeout_sec=1.0), time.monotonic())
none.call_async(AddTwoInts.Request())
time.sleep(1)
"""
        err = [
            "hrdsl: service /other (example_interfaces/srv/AddTwoInts): a request of client is never answered: the "
            "service `/other` has no server",
        ]
        out = [
            "True True",
            "add example_interfaces.srv.AddTwoInts_Request(a=1, b=2)",
            "example_interfaces.srv.AddTwoInts_Response(sum=3) True",
            "TypeError: ",
            "add example_interfaces.srv.AddTwoInts_Request(a=5, b=6)",
            "11",
            "add example_interfaces.srv.AddTwoInts_Request(a=7, b=8)",
            "True 15",
            "False 2.0",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)

    def test_of_the_world(self):
        text = TRIED + """
from std_srvs.srv import SetBool
rclpy.init()
n = Node("n")
client = n.create_client(SetBool, "/light")
future = client.call_async(SetBool.Request(data=True))
rclpy.spin_until_future_complete(n, future)
print(future.result())
n.create_service(SetBool, "door", lambda request, response: print("door", request.data))
tried(lambda: rclpy.spin(n))
"""
        system = System(
            [(SECOND, lambda world: world.call("/door", {"data": False}))],
            services={"/light": lambda request: {"success": request["data"], "message": "on"}},
        )
        out = [
            "std_srvs.srv.SetBool_Response(success=True, message='on')",
            "door False",
            "TypeError: service /door: the callback has to return a SetBool_Response, and has returned a NoneType",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_a_call_that_keeps_its_answer_from_coming(self):
        text = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger
rclpy.init()
n = Node("n")
n.create_service(Trigger, "t", lambda request, response: response)
client = n.create_client(Trigger, "t")
n.create_timer(1.0, lambda: print("never", client.call(Trigger.Request())))
try:
    rclpy.spin(n)
finally:
    print("cleaning up")
    n.destroy_node()
    rclpy.shutdown()
    print("cleaned up")
"""
        finished = run_ros2(text, system=System(end=5 * SECOND))
        self.assertEqual((finished.code, finished.out), (0, "cleaning up\ncleaned up\n"))
        self.assertIn("the client of /t (std_srvs/srv/Trigger) has no answer to its call of 1.000 s", finished.err)


class Actions(Ros2Case):
    def test_a_server_and_a_client(self):
        text = """
import rclpy, time
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from example_interfaces.action import Fibonacci

class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.server = ActionServer(
            self, Fibonacci, "fib", self.run, callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal: GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT,
            cancel_callback=lambda handle: CancelResponse.ACCEPT)

    def run(self, handle):
        feedback = Fibonacci.Feedback(sequence=[0, 1])
        for i in range(1, handle.request.order):
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result()
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            handle.publish_feedback(feedback)
            time.sleep(1)
        handle.succeed()
        return Fibonacci.Result(sequence=feedback.sequence)

class Client(Node):
    def __init__(self):
        super().__init__("client")
        self.client = ActionClient(self, Fibonacci, "fib")

    def say(self, *what):
        print("%g" % time.monotonic(), *what)

    def go(self, order):
        self.client.wait_for_server()
        sent = self.client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.feedback)
        sent.add_done_callback(self.answered)

    def feedback(self, message):
        self.say("feedback", list(message.feedback.sequence), len(message.goal_id.uuid))

    def answered(self, future):
        self.goal_handle = future.result()
        self.say("accepted", self.goal_handle.accepted, self.goal_handle.status)
        if self.goal_handle.accepted:
            self.goal_handle.get_result_async().add_done_callback(self.done)

    def done(self, future):
        self.say("result", future.result().status, list(future.result().result.sequence), self.goal_handle.status)

    def cancel(self):
        asked = self.goal_handle.cancel_goal_async()
        asked.add_done_callback(lambda f: self.say("cancel", len(f.result().goals_canceling), f.result().return_code))

def once(seconds, call):
    timer = client.create_timer(seconds, lambda: (timer.cancel(), call()))

rclpy.init()
server, client = Server(), Client()
executor = MultiThreadedExecutor()
executor.add_node(server)
executor.add_node(client)
client.go(4)
once(5.0, lambda: client.go(-1))
once(6.0, lambda: client.go(10))
once(8.5, client.cancel)
once(10.5, client.cancel)
executor.spin()
"""
        system = System(end=12 * SECOND)
        out = [
            "0 accepted True 2",
            "0 feedback [0, 1, 1] 16",
            "1 feedback [0, 1, 1, 2] 16",
            "2 feedback [0, 1, 1, 2, 3] 16",
            "3 result 4 [0, 1, 1, 2, 3] 4",
            "5 accepted False 0",
            "6 feedback [0, 1, 1] 16",
            "6 accepted True 2",
            "7 feedback [0, 1, 1, 2] 16",
            "8 feedback [0, 1, 1, 2, 3] 16",
            "8.5 cancel 1 0",
            "9 result 5 [] 5",
            "10.5 cancel 0 3",
        ]
        self.assertEqual(self.said(text, system), out)

    def test_servers_that_fail(self):
        text = TRIED + """
from rclpy.action import ActionClient, ActionServer
from example_interfaces.action import Fibonacci
rclpy.init()
n = Node("n")
modes = iter(["forget", "succeed twice", "cancel"])

def run(handle):
    mode = next(modes)
    if mode == "succeed twice":
        handle.succeed()
        tried(handle.succeed)
    elif mode == "cancel":
        tried(handle.canceled)
        handle.abort()
    return Fibonacci.Result()

async def main():
    client = ActionClient(n, Fibonacci, "fib")
    for _ in range(3):
        handle = await client.send_goal_async(Fibonacci.Goal(order=1))
        print(handle.accepted, (await handle.get_result_async()).status)
    try:
        await client.send_goal_async(3)
    except TypeError:
        print("TypeError")

server = ActionServer(n, Fibonacci, "fib", run)
tried(lambda: ActionServer(n, Fibonacci, "other", None))
import re
error = sys.stderr.write
sys.stderr.write = lambda text: error(re.sub("ID: .*", "ID: ...", text))
executor = rclpy.get_global_executor()
executor.add_node(n)
executor.spin_until_future_complete(executor.create_task(main))
"""
        err = [
            "[WARN] [1735689600.000000000] [n]: Goal state not set, assuming aborted. Goal ID: ...",
        ]
        out = [
            "TypeError: Failed to register goal execution callback: not callable",
            "True 6",
            "RCLError: Failed to update goal state: goal_handle attempted invalid transition from state SUCCEEDED "
            "with event SUCCEED",
            "True 4",
            "RCLError: Failed to update goal state: goal_handle attempted invalid transition from state EXECUTING "
            "with event CANCELED",
            "True 6",
            "TypeError",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)

    def test_of_the_world(self):
        text = TRIED + """
from rclpy.action import ActionClient
from example_interfaces.action import Fibonacci
rclpy.init()
n = Node("n")

def now():
    return n.get_clock().now().nanoseconds / 1e9 - 1735689600

async def main():
    client = ActionClient(n, Fibonacci, "/count")
    for order in 3, 5, -1, 7:
        handle = await client.send_goal_async(Fibonacci.Goal(order=order), lambda f: print("feedback", list(f.feedback.sequence)))
        print(order, handle.accepted, handle.status, now())
        if order == 7:
            answer = await handle.cancel_goal_async()
            print("cancel", len(answer.goals_canceling), handle.status)
        result = await handle.get_result_async()
        print(result.status, list(result.result.sequence), now())
    none = ActionClient(n, Fibonacci, "/none")
    print(none.server_is_ready(), none.wait_for_server(timeout_sec=0.5))
    none.send_goal_async(Fibonacci.Goal())
    rclpy.spin_once(n, timeout_sec=1.0)

executor = rclpy.get_global_executor()
executor.add_node(n)
executor.spin_until_future_complete(executor.create_task(main))
rclpy.spin_once(n, timeout_sec=0.5)
"""
        system = System(actions={"/count": world})
        out = [
            "3 True 2 0.0",
            "feedback [0]",
            "4 [0, 1, 2] 3.0",
            "5 True 2 3.0",
            "feedback [0]",
            "6 [0, 1, 2, 3, 4] 8.0",
            "-1 False 0 8.0",
            "0 [] 8.0",
            "7 True 2 8.0",
            "cancel 1 3",
            "5 [] 8.0",
            "False False",
        ]
        err = (
            "hrdsl: action /none (example_interfaces/action/Fibonacci): a goal of n is never answered: "
            "the action `/none` has no server\n"
        )
        self.assertEqual(self.said(text, system, err=err), out)


if __name__ == "__main__":
    unittest.main()
