"""`ActionClient` and `ActionServer`: goal handles and their states."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from actionlib_msgs.msg import GoalStatus

rospy.init_node("action_lowlevel")
handles = []


def goal_came(handle):
    number = handle.get_goal().goal
    handles.append(handle)
    print("goal", number, handle.get_goal_status().status)
    if number == 1:
        handle.set_accepted("taken")
    elif number == 2:
        handle.set_rejected(TestResult(5), "not this one")
    else:
        handle.set_accepted()


def cancel_came(handle):
    print("cancel", handle.get_goal().goal, handle.get_goal_status().status)
    handle.set_canceled(TestResult(6), "cancelled")


server = actionlib.ActionServer("work", TestAction, goal_came, cancel_came, auto_start=False)
server.start()
client = actionlib.ActionClient("work", TestAction)
print(client.wait_for_server(rospy.Duration(5)))
rospy.sleep(0.5)
states = []


def transition(handle):
    states.append(actionlib.CommState.to_string(handle.get_comm_state()))


def shown(handle):
    rospy.sleep(0.6)
    result = handle.get_result()
    print(states[0] if states else None, states[-1] if states else None, handle.get_goal_status(), handle.get_goal_status_text(), result and result.result)
    del states[:]


first = client.send_goal(TestGoal(1), transition, lambda handle, feedback: print("feedback", feedback.feedback))
shown(first)
handles[0].publish_feedback(TestFeedback(4))
rospy.sleep(0.3)
handles[0].set_succeeded(TestResult(9), "well done")
shown(first)
print(actionlib.TerminalState.to_string(first.get_terminal_state()))
second = client.send_goal(TestGoal(2), transition)
shown(second)
print(actionlib.TerminalState.to_string(second.get_terminal_state()))
third = client.send_goal(TestGoal(3), transition)
rospy.sleep(0.5)
third.cancel()
shown(third)
print(actionlib.TerminalState.to_string(third.get_terminal_state()), third == third, third == first)
