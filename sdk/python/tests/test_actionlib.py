"""`actionlib` between programs: clients whose servers are outside, servers that are called from outside, and both in one."""

import unittest

from system import System
from tables import run_ros

SECOND = 10**9

COUNT = "int32 to\n---\nint32 reached\n---\nint32 at\n"
MORE = {"counting__Count": COUNT}

IMPORTS = """
import sys
import rospy, actionlib
from actionlib_msgs.msg import GoalStatus
from counting.msg import CountAction, CountGoal, CountResult, CountFeedback

def say(*what):
    print("%.3f" % (rospy.get_time() - 1735689600), *what)

"""


def server(name="/count"):
    return {"kind": "action_server", "name": name, "type": "counting/Count", "program": "other"}


def counts(goal):
    """Counts, a number in half a second."""
    steps = [(n * SECOND // 2, {"at": n}) for n in range(1, goal["to"])]
    return steps + [(goal["to"] * SECOND // 2, "succeeded", {"reached": goal["to"]})]


class Case(unittest.TestCase):
    def said(self, text, system=None):
        done = run_ros(IMPORTS + text, ["actionlib_msgs", "std_msgs"], system, MORE)
        self.assertEqual(done.code, 0, done.err)
        self.err, self.requests = done.err, done.requests
        return done.out.splitlines()


class Clients(Case):
    def test_a_goal_its_feedback_and_its_result(self):
        text = """
client = actionlib.SimpleActionClient("count", CountAction)  # before there is a node
rospy.init_node("counter")
say(client.get_state() == GoalStatus.LOST, client.wait_for_server(rospy.Duration(5)))
client.send_goal(
    CountGoal(3),
    done_cb=lambda state, result: say("done", GoalStatus.to_string(state), result.reached),
    active_cb=lambda: say("active"),
    feedback_cb=lambda feedback: say("at", feedback.at),
)
say(client.get_state(), client.wait_for_result(rospy.Duration(0.2)), client.get_state(), client.get_result())
say(client.wait_for_result(), client.get_state() == GoalStatus.SUCCEEDED, client.get_result().reached)
"""
        out = self.said(text, System(actions={"/count": counts}, others=[server()]))
        self.assertEqual(
            out,
            [
                "0.000 True True",
                "0.000 active",
                "0.200 0 False 1 None",
                "0.500 at 1",
                "1.000 at 2",
                "1.500 done SUCCEEDED 3",
                "1.500 True True 3",
            ],
        )
        opened = [request for request in self.requests if request.get("kind") == "action_client"]
        self.assertEqual([(port["name"], port["type"]) for port in opened], [("/count", "counting/Count")])

    def test_a_server_that_comes_later(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
say(client.wait_for_server(rospy.Duration(1.5)))
say(client.wait_for_server())
say(client.send_goal_and_wait(CountGoal(1)))
"""
        later = [(2 * SECOND, lambda system: system.others_open("action_server", "/count", "counting/Count"))]
        system = System(later, actions={"/count": counts})
        out = self.said(text, system)
        self.assertEqual(out, ["1.500 False", "2.000 True", "2.500 3"])
        count = {"request": "await", "kind": "action_client", "name": "/count", "type": "counting/Count"}
        self.assertEqual(system.awaited, [{**count, "give_up": 3 * SECOND // 2}, count])

    def test_who_waits_too_long_cancels(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
say(GoalStatus.to_string(client.send_goal_and_wait(CountGoal(9), rospy.Duration(1), rospy.Duration(1))))
client.send_goal(CountGoal(9), done_cb=lambda state, result: say("done", state, result.reached))
rospy.sleep(0.5)
client.cancel_all_goals()
say(client.wait_for_result(), client.get_state())
client.send_goal(CountGoal(9))
rospy.sleep(0.5)
client.cancel_goal()
say(client.wait_for_result(), client.get_state())
"""
        out = self.said(text, System(actions={"/count": counts}, others=[server()]))
        self.assertEqual(out, ["1.000 PREEMPTED", "1.500 done 2 0", "1.500 True 2", "2.000 True 2"])

    def test_rejected_and_aborted(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
for to in (1, 2):
    client.send_goal(CountGoal(to), lambda *ended: say("done", *ended), lambda: say("active"))
    say(client.wait_for_result(), client.get_state())
"""
        ends = {1: [(0, "rejected", {"reached": 0})], 2: [(SECOND, "aborted", {"reached": 1})]}
        system = System(actions={"/count": lambda goal: ends[goal["to"]]}, others=[server()])
        out = self.said(text, system)
        self.assertEqual(
            out,
            ["0.000 done 5 reached: 0", "0.000 True 5", "0.000 active", "1.000 done 4 reached: 1", "1.000 True 4"],
        )
        self.assertNotIn("rror", self.err)

    def test_without_a_server_the_goal_stays_pending(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
client.send_goal(CountGoal(1))
say(client.wait_for_result(rospy.Duration(3)), client.get_state(), client.get_result())
"""
        self.assertEqual(self.said(text), ["3.000 False 0 None"])

    def test_feedback_says_that_a_goal_is_active(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
client.send_goal(CountGoal(2), active_cb=lambda: say("active"), feedback_cb=lambda feedback: say("at", feedback.at))
say(client.wait_for_result(), client.get_state())
"""
        out = self.said(text, System(actions={"/count": counts}, accepts=False))
        self.assertEqual(out, ["0.500 active", "0.500 at 1", "1.000 True 3"])

    def test_a_loop_that_asks_for_the_state_lets_time_pass(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
client.send_goal(CountGoal(1))
while client.get_state() not in (GoalStatus.SUCCEEDED, GoalStatus.ABORTED):
    pass
print(0.5 <= rospy.get_time() - 1735689600 < 0.51)
"""
        self.assertEqual(self.said(text, System(actions={"/count": counts}, others=[server()])), ["True"])

    def test_several_goals_at_a_time(self):
        text = """
rospy.init_node("counter")
client = actionlib.ActionClient("/count", CountAction)
def tell(handle):
    say(handle.comm_state_machine.action_goal.goal.to, actionlib.CommState.to_string(handle.get_comm_state()))
kept = [client.send_goal(CountGoal(to), tell) for to in (2, 1)]
client.send_goal(CountGoal(3), tell)  # nobody keeps its handle
rospy.sleep(0.6)
kept[0].cancel()
rospy.sleep(1)
say([actionlib.TerminalState.to_string(handle.get_terminal_state()) for handle in kept], kept[1].get_result().reached)
say(kept[0] == kept[0], kept[0] != kept[1], len({*kept, kept[0]}))
"""
        out = self.said(text, System(actions={"/count": counts}, others=[server()]))
        ending = ["WAITING_FOR_RESULT", "DONE"]
        self.assertEqual(
            out,
            ["0.000 2 ACTIVE", "0.000 1 ACTIVE"]
            + ["0.500 1 " + state for state in ending]
            + ["0.600 2 WAITING_FOR_CANCEL_ACK", "0.600 2 PREEMPTING"]
            + ["0.600 2 " + state for state in ending]
            + ["1.600 ['PREEMPTED', 'SUCCEEDED'] 1", "1.600 True True 2"],
        )

    def test_a_goal_that_waits_is_pending_and_can_be_recalled(self):
        text = """
rospy.init_node("both")
def on_cancel(handle):
    say("server", GoalStatus.to_string(handle.get_goal_status().status))
    if handle.get_goal().to == 1:
        handle.set_canceled(CountResult(0), "never begun")
    else:
        handle.set_accepted("late")
        handle.set_aborted(CountResult(5), "stopped")
server = actionlib.ActionServer("/count", CountAction, lambda handle: None, on_cancel, False)
server.start()
client = actionlib.ActionClient("/count", CountAction)
def tell(handle):
    to = handle.comm_state_machine.action_goal.goal.to
    status = GoalStatus.to_string(handle.get_goal_status())
    say(to, actionlib.CommState.to_string(handle.get_comm_state()), status, handle.get_goal_status_text())
kept = [client.send_goal(CountGoal(to), tell) for to in (1, 2)]
rospy.sleep(1)
for handle in kept:
    handle.cancel()
rospy.sleep(1)
say([actionlib.TerminalState.to_string(handle.get_terminal_state()) for handle in kept], kept[1].get_result().reached)
rospy.signal_shutdown("all done")
"""
        self.assertEqual(
            self.said(text),
            [
                "0.200 1 PENDING PENDING ",
                "0.200 2 PENDING PENDING ",
                "1.000 1 WAITING_FOR_CANCEL_ACK PENDING ",
                "1.000 2 WAITING_FOR_CANCEL_ACK PENDING ",
                "1.000 server RECALLING",
                "1.000 server RECALLING",
                "1.000 1 RECALLING RECALLING ",
                "1.000 2 RECALLING RECALLING ",
                "1.000 2 PREEMPTING PREEMPTING late",
                "1.000 1 WAITING_FOR_RESULT RECALLED never begun",
                "1.000 1 DONE RECALLED never begun",
                "1.000 2 WAITING_FOR_RESULT ABORTED stopped",
                "1.000 2 DONE ABORTED stopped",
                "2.000 ['RECALLED', 'ABORTED'] 5",
            ],
        )

    def test_what_the_server_says_is_its_clients_to_read(self):
        text = """
rospy.init_node("both")
def execute(goal):
    rospy.sleep(1)
    server.set_succeeded(CountResult(goal.to), "counted")
server = actionlib.SimpleActionServer("/count", CountAction, execute, False)
server.start()
client = actionlib.SimpleActionClient("/count", CountAction)
client.send_goal(CountGoal(1))
say(client.get_state(), client.get_goal_status_text())
rospy.sleep(0.5)
say(client.get_state(), client.get_goal_status_text())
client.wait_for_result()
say(client.get_state(), client.get_goal_status_text())
rospy.signal_shutdown("all done")
"""
        accepted = "This goal has been accepted by the simple action server"
        self.assertEqual(self.said(text), ["0.000 0 ", "0.500 1 " + accepted, "1.000 3 counted"])

    def test_all_goals_of_a_server_can_be_cancelled(self):
        text = """
rospy.init_node("both")
kept = []
def on_goal(handle):
    handle.set_accepted()
    kept.append(handle)
server = actionlib.ActionServer("/count", CountAction, on_goal, lambda handle: handle.set_canceled(), False)
server.start()
clients = [actionlib.SimpleActionClient("/count", CountAction) for _ in range(2)]
for client in clients:
    client.send_goal(CountGoal(1))
rospy.sleep(1)
clients[1].cancel_all_goals()
say([client.wait_for_result(rospy.Duration(1)) for client in clients], [client.get_state() for client in clients])
rospy.signal_shutdown("all done")
"""
        self.assertEqual(self.said(text), ["1.000 [True, True] [2, 2]"])

    def test_what_fits_not(self):
        text = """
rospy.init_node("counter")
for wrong in (
    lambda: actionlib.SimpleActionClient("/count", CountGoal),
    lambda: actionlib.SimpleActionClient("/count", CountAction).send_goal(CountResult()),
    lambda: actionlib.SimpleActionClient("/count", CountAction).send_goal(CountGoal("many")),
):
    try:
        wrong()
    except (actionlib.ActionException, rospy.ROSException) as error:
        print(type(error).__name__, error)
"""
        out = self.said(text)
        self.assertIn("ActionException Type is not an action spec", out[0])
        self.assertEqual(out[1], "ROSSerializationException action /count takes a counting/CountGoal, not a CountResult")
        self.assertIn("ROSSerializationException action /count: field to must be an integer type", out[2])

    def test_a_callback_that_fails_is_told(self):
        text = """
rospy.init_node("counter")
client = actionlib.SimpleActionClient("/count", CountAction)
client.send_goal(CountGoal(2), feedback_cb=lambda feedback: 1 / 0)
say(client.wait_for_result())
"""
        self.assertEqual(self.said(text, System(actions={"/count": counts}, others=[server()])), ["1.000 True"])
        self.assertIn("bad callback: ActionClient._feedback_cb for /count/feedback\n", self.err)
        self.assertIn("ZeroDivisionError", self.err)


class Servers(Case):
    def outside(self, *steps):
        """A harness that does something at some times, and knows the number of the first goal."""
        system = System()
        system.numbers = []
        for time, step in steps:
            system.later(time, step)
        return system

    @staticmethod
    def goal(to):
        return lambda system: system.numbers.append(system.call("/count", {"to": to}, "action_server"))

    @staticmethod
    def cancel(at):
        def step(system):
            (port,) = system.at("action_server", "/count")
            system.mailbox.append({"canceled": system.numbers[at], "port": port})

        return step

    def told(self):
        kinds = ("feedback", "finish")
        return [
            (request["call"], request["message"], request.get("end")) for request in self.requests if request["request"] in kinds
        ]

    def test_execute_runs_in_a_thread(self):
        text = """
def execute(goal):
    say("begin", goal.to)
    for at in range(1, goal.to):
        rospy.sleep(0.5)
        if server.is_preempt_requested():
            server.set_preempted(CountResult(at))
            return say("preempted")
        server.publish_feedback(CountFeedback(at))
    server.set_succeeded(CountResult(goal.to), "well done")
    say("end")

rospy.init_node("server")
server = actionlib.SimpleActionServer("count", CountAction, execute, False)
server.start()
rospy.spin()
"""
        # The second replaces the first, and is accepted a tenth of a second after that has ended.
        system = self.outside((SECOND, self.goal(9)), (2 * SECOND + 1, self.goal(3)), (9 * SECOND, self.goal(8)))
        system.later(10 * SECOND, self.cancel(2))
        system.end = 20 * SECOND
        out = self.said(text, system)
        self.assertEqual(
            out,
            ["1.000 begin 9", "2.500 preempted", "2.600 begin 3", "3.600 end", "9.000 begin 8", "10.500 preempted"],
        )
        a, b, c = system.numbers
        self.assertEqual(
            self.told(),
            [
                (a, {"at": 1}, None),
                (a, {"at": 2}, None),
                (a, {"reached": 3}, "canceled"),
                (b, {"at": 1}, None),
                (b, {"at": 2}, None),
                (b, {"reached": 3}, "succeeded"),
                (c, {"at": 1}, None),
                (c, {"at": 2}, None),
                (c, {"reached": 3}, "canceled"),
            ],
        )

    def test_callbacks_tell_of_goals(self):
        text = """
rospy.init_node("server")
server = actionlib.SimpleActionServer("/count", CountAction, auto_start=False)
def on_goal():
    goal = server.accept_new_goal()
    say("goal", goal.to, server.is_active(), server.is_preempt_requested())
def on_preempt():
    say("preempt")
    if not server.is_new_goal_available():
        server.set_aborted()
server.register_goal_callback(on_goal)
server.register_preempt_callback(on_preempt)
server.start()
rospy.spin()
"""
        system = self.outside((SECOND, self.goal(1)), (2 * SECOND, self.goal(2)), (3 * SECOND, self.cancel(1)))
        system.end = 5 * SECOND
        out = self.said(text, system)
        self.assertEqual(out, ["1.000 goal 1 True False", "2.000 preempt", "2.000 goal 2 True False", "3.000 preempt"])
        self.assertEqual([end for _, _, end in self.told()], ["canceled", "aborted"])

    def test_an_execution_that_says_nothing_or_fails(self):
        text = """
rospy.init_node("server")
server = actionlib.SimpleActionServer("/count", CountAction, lambda goal: 1 // goal.to, False)
server.start()
rospy.spin()
"""
        system = self.outside((SECOND, self.goal(1)), (2 * SECOND, self.goal(0)))
        system.end = 5 * SECOND
        self.said(text, system)
        self.assertEqual([end for _, _, end in self.told()], ["aborted", "aborted"])
        self.assertIn("Your executeCallback did not set the goal to a terminal status.", self.err)
        self.assertIn("Exception in your execute callback: integer division or modulo by zero", self.err)

    def test_handles_of_goals(self):
        text = """
rospy.init_node("server")
def on_goal(handle):
    say(handle.get_goal().to, handle.get_goal_status().status, handle.get_goal_id().id.rsplit("-", 1)[0])
    if handle.get_goal().to > 5:
        return handle.set_rejected()
    handle.set_succeeded()  # too early
    handle.set_accepted()
    kept.append(handle)
kept = []
server = actionlib.ActionServer("/count", CountAction, on_goal, lambda handle: handle.set_canceled(CountResult(7)), False)
server.start()
rospy.sleep(3.5)
kept[0].publish_feedback(CountFeedback(1))
kept[0].set_succeeded(CountResult(4))
kept[0].set_aborted()
actionlib.ServerGoalHandle().set_accepted()
"""
        steps = (SECOND, self.goal(4)), (2 * SECOND, self.goal(6)), (2 * SECOND, self.goal(5)), (3 * SECOND, self.cancel(2))
        system = self.outside(*steps)
        self.assertEqual(self.said(text, system), ["1.000 4 0 /server-1", "2.000 6 0 /server-2", "2.000 5 0 /server-3"])
        a, b, c = system.numbers
        self.assertEqual(
            self.told(),
            [
                (b, {"reached": 0}, "rejected"),
                (c, {"reached": 7}, "canceled"),
                (a, {"at": 1}, None),
                (a, {"reached": 4}, "succeeded"),
            ],
        )
        for text in (
            "To transition to a succeeded state, the goal must be in a preempting or active state, it is currently in state: 0",
            "To transition to an aborted state, the goal must be in a preempting or active state, it is currently in state: 3",
            "Attempt to set status on an uninitialized ServerGoalHandle",
        ):
            self.assertIn(text, self.err)

    def test_a_client_and_its_server_in_one_program(self):
        text = """
rospy.init_node("both")
def execute(goal):
    rospy.sleep(goal.to)
    server.set_succeeded(CountResult(goal.to))
server = actionlib.SimpleActionServer("/count", CountAction, execute, False)
server.start()
client = actionlib.SimpleActionClient("/count", CountAction)
say(client.wait_for_server())
say(client.send_goal_and_wait(CountGoal(2)), client.get_result().reached)
say(client.send_goal_and_wait(CountGoal(2), rospy.Duration(1)), client.get_result().reached)
rospy.signal_shutdown("all done")
"""
        self.assertEqual(self.said(text), ["0.000 True", "2.000 3 2", "4.000 3 2"])


if __name__ == "__main__":
    unittest.main()
