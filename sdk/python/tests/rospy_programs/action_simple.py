"""A simple action: a goal, its feedback, its result, and its states."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from actionlib_msgs.msg import GoalStatus

rospy.init_node("action_simple")


def execute(goal):
    rospy.sleep(0.3)
    print("execute", goal.goal, server.is_active(), server.is_preempt_requested(), server.is_new_goal_available())
    for number in range(2):
        rospy.sleep(0.2)
        server.publish_feedback(TestFeedback(number))
    rospy.sleep(0.2)
    if goal.goal == 2:
        server.set_aborted(TestResult(20), "no way")
    elif goal.goal == 3:
        raise ValueError("bad goal")
    elif goal.goal == 4:
        return
    else:
        server.set_succeeded(TestResult(10), "done")


server = actionlib.SimpleActionServer("work", TestAction, execute_cb=execute, auto_start=False)
client = actionlib.SimpleActionClient("work", TestAction)
print(client.wait_for_server(rospy.Duration(0.3)), client.get_state())
server.start()
print(client.wait_for_server(rospy.Duration(5)), GoalStatus.to_string(client.get_state()))
rospy.sleep(0.5)


def sent(number):
    client.send_goal(
        TestGoal(number),
        done_cb=lambda state, result: print("done", GoalStatus.to_string(state), None if result is None else result.result),
        feedback_cb=lambda feedback: print("feedback", feedback.feedback),
    )
    waited = client.wait_for_result(rospy.Duration(5))
    rospy.sleep(0.5)
    print("waited", waited)
    result = client.get_result()
    print(GoalStatus.to_string(client.get_state()), repr(client.get_goal_status_text()), None if result is None else result.result)
    print(client.simple_state, actionlib.SimpleGoalState.to_string(client.simple_state), server.is_active())


sent(1)
sent(2)
rospy.signal_shutdown("the execute thread waits for the end")
