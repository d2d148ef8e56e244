"""`smach_ros`: states that call services and actions, and listen to topics; machines as servers of actions."""

import unittest

from system import System
from tables import run_ros

SECOND = 10**9

MORE = {"counting__Count": "int32 to\n---\nint32 reached\n---\nint32 at\n", "counting__Add": "int32 a\nint32 b\n---\nint32 sum\n"}

IMPORTS = """
import rospy, smach, smach_ros
from counting.msg import CountAction, CountGoal, CountFeedback
from counting.srv import Add, AddRequest
from std_msgs.msg import Int8

def say(*what):
    print("%.3f" % (rospy.get_time() - 1735689600), *what)

def machine(state, *outcomes, **data):
    made = smach.StateMachine(outcomes=outcomes)
    for name, value in data.items():
        made.userdata[name] = value
    with made:
        smach.StateMachine.add("ONLY", state)
    return made

rospy.init_node("thinker", log_level=rospy.WARN)
"""

SERVER = {"kind": "action_server", "name": "/count", "type": "counting/Count", "program": "other"}


def counts(goal):
    return [(goal["to"] * SECOND, "succeeded", {"reached": goal["to"]})]


class Case(unittest.TestCase):
    def said(self, text, system=None):
        done = run_ros(IMPORTS + text, ["actionlib_msgs", "std_msgs"], system, MORE)
        self.assertEqual(done.code, 0, done.err)
        self.err, self.requests = done.err, done.requests
        return [line for line in done.out.splitlines() if not line.startswith("[")]


class States(Case):
    def test_an_action(self):
        text = """
@smach.cb_interface(input_keys=["n"])
def make(ud, goal):
    goal.to = ud.n + 1
state = smach_ros.SimpleActionState("count", CountAction, goal_cb=make, result_slots=["reached"], result_key="all")
it = machine(state, "succeeded", "aborted", "preempted", n=2)
say(it.execute(), it.userdata.reached, it.userdata.all.reached)

seen = []
state = smach_ros.SimpleActionState(
    "count", CountAction, goal=CountGoal(9), exec_timeout=rospy.Duration(1.95),
    result_cb=lambda ud, status, result: seen.append(status),
)
say(machine(state, "succeeded", "aborted", "preempted").execute(), seen)
state = smach_ros.SimpleActionState("count", CountAction, goal_slots=["to"])
it = machine(state, "succeeded", "aborted", "preempted", to=9)
rospy.Timer(rospy.Duration(1), lambda event: it.request_preempt(), oneshot=True)
say(it.execute())
state = smach_ros.SimpleActionState("nobody", CountAction, server_wait_timeout=rospy.Duration(3))
say(machine(state, "succeeded", "aborted", "preempted").execute())
try:
    smach_ros.SimpleActionState("count", CountAction, goal_slots=["from"])
except smach.InvalidStateError as error:
    print(error)
rospy.signal_shutdown("done")
"""
        out = self.said(text, System(actions={"/count": counts}, others=[SERVER]))
        self.assertEqual(
            out,
            [
                "3.000 succeeded 3 3",
                "5.000 aborted [2]",
                "6.000 preempted",
                "9.000 aborted",
                "Goal slots specified are not valid slots. Available slots: ['to']; specified slots: ['from']",
            ],
        )

    def test_a_service(self):
        text = """
state = smach_ros.ServiceState("add", Add, request_slots=["a", "b"], response_slots=["sum"])
it = machine(state, "succeeded", "aborted", "preempted", a=3, b=4)
say(it.execute(), it.userdata.sum)

@smach.cb_interface(outcomes=["big", "small"], output_keys=["seen"])
def look(ud, response):
    ud.seen = response.sum
    return "big" if response.sum > 5 else "small"
state = smach_ros.ServiceState("add", Add, request=AddRequest(1, 2), response_cb=look)
it = machine(state, "succeeded", "aborted", "preempted", "big", "small")
say(it.execute(), it.userdata.seen)
state = smach_ros.ServiceState("add", Add, request_cb=lambda ud, request: 1 / 0)
say(machine(state, "succeeded", "aborted", "preempted").execute())
state = smach_ros.ServiceState("add", Add, request=AddRequest(-1, 2))
say(machine(state, "succeeded", "aborted", "preempted").execute())
"""

        def add(message):
            return "no" if message["a"] < 0 else {"sum": message["a"] + message["b"]}

        other = {"kind": "server", "name": "/add", "type": "counting/Add", "program": "other"}
        out = self.said(text, System(services={"/add": add}, others=[other]))
        self.assertEqual(out, ["0.000 succeeded 7", "0.000 small 3", "0.000 aborted", "0.000 aborted"])
        self.assertIn("Could not execute request callback", self.err)

    def test_a_topic(self):
        text = """
state = smach_ros.MonitorState("level", Int8, lambda ud, message: message.data < 3)
say(machine(state, "valid", "invalid", "preempted").execute())
state = smach_ros.MonitorState("level", Int8, lambda ud, message: message.data > 3, max_checks=2)
say(machine(state, "valid", "invalid", "preempted").execute())
state = smach_ros.MonitorState("level", Int8, lambda ud, message: True)
it = machine(state, "valid", "invalid", "preempted")
rospy.Timer(rospy.Duration(1), lambda event: it.request_preempt(), oneshot=True)
say(it.execute())
"""
        arrivals = [(n * SECOND, {"topic": "/level", "message": {"data": n}}) for n in range(1, 7)]
        self.assertEqual(self.said(text, System(arrivals)), ["3.000 invalid", "5.000 valid", "6.000 preempted"])

    def test_a_condition(self):
        text = """
def later(ud):
    return rospy.get_time() - 1735689600 > 0.99
state = smach_ros.ConditionState(later, max_checks=-1, poll_rate=rospy.Duration(0.25))
say(machine(state, "true", "false", "preempted").execute())
state = smach_ros.ConditionState(lambda ud: False, max_checks=3)
say(machine(state, "true", "false", "preempted").execute())
state = smach_ros.ConditionState(lambda ud: False, max_checks=-1, timeout=rospy.Duration(1))
say(machine(state, "true", "false", "preempted").execute())
"""
        self.assertEqual(self.said(text), ["1.000 true", "1.200 false", "2.250 false"])


class Machines(Case):
    def test_who_looks_whether_to_end_lets_time_pass(self):
        text = """
def work(ud):
    while not state.preempt_requested():
        pass
    state.service_preempt()
    return "preempted"
state = smach.CBState(work, outcomes=["preempted"])
it = machine(state, "preempted")
rospy.Timer(rospy.Duration(0.05), lambda event: it.request_preempt(), oneshot=True)
print(it.execute(), round(rospy.get_time() - 1735689600, 2))
"""
        self.assertEqual(self.said(text), ["preempted 0.05"])

    def test_a_machine_serves_an_action_and_tells_how_it_moves(self):
        text = """
class Count(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["counted", "preempted"], input_keys=["goal"], output_keys=["feedback", "result"])
    def execute(self, ud):
        for at in range(ud.goal.to):
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            rospy.sleep(1)
        ud.feedback = CountFeedback(at)
        return "counted"

it = smach.StateMachine(outcomes=["done", "preempted"], input_keys=["action_goal"], output_keys=["action_feedback"])
with it:
    remapping = {"goal": "action_goal", "feedback": "action_feedback"}
    smach.StateMachine.add("COUNT", Count(), {"counted": "REST"}, remapping)
    smach.StateMachine.add("REST", smach.CBState(lambda ud: "done", outcomes=["done"]))
server = smach_ros.IntrospectionServer("viewer", it, "/SM_ROOT")
server.start()
wrapper = smach_ros.ActionServerWrapper("count", CountAction, it, ["done"], [], ["preempted"])
wrapper.run_server()
smach_ros.set_preempt_handler(it)
rospy.spin()
"""
        system, numbers = System(end=9 * SECOND), []
        system.later(SECOND, lambda _: numbers.append(system.call("/count", {"to": 2}, "action_server")))
        system.later(4 * SECOND, lambda _: numbers.append(system.call("/count", {"to": 5}, "action_server")))

        def cancel(_):
            (port,) = system.at("action_server", "/count")
            system.mailbox.append({"canceled": numbers[1], "port": port})

        system.later(6 * SECOND + 1, cancel)
        self.said(text, system)
        told = [request for request in self.requests if request["request"] in ("feedback", "finish", "machine", "transition")]
        declared = told.pop(0)
        self.assertEqual((declared["name"], declared["states"]), ("SM_ROOT", ["COUNT", "REST"]))
        edges = [["COUNT", "counted", "REST"], ["COUNT", "preempted", "preempted"], ["REST", "done", "done"]]
        self.assertEqual(declared["transitions"], edges)
        self.assertEqual(
            [[request["request"], request.get("label"), request.get("end"), request.get("next")] for request in told],
            [
                ["transition", None, None, "COUNT"],
                ["transition", "COUNT", None, "REST"],
                ["feedback", None, None, None],
                ["transition", "REST", None, "done"],
                ["finish", None, "succeeded", None],
                ["transition", None, None, "COUNT"],
                ["transition", "COUNT", None, "preempted"],
                ["finish", None, "canceled", None],
            ],
        )
        self.assertEqual(told[2]["message"], {"at": 1})


if __name__ == "__main__":
    unittest.main()
