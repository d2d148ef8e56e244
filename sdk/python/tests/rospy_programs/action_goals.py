"""A server without an execute callback, that accepts goals itself."""
# departs: `GoalStatus.to_string(0)` is `PENDING`, not the name of an attribute that is false
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from actionlib_msgs.msg import GoalStatus

rospy.init_node("action_goals")


def came():
    goal = server.accept_new_goal()
    print("accepted", goal.goal, server.is_active(), server.is_new_goal_available())
    server.publish_feedback(TestFeedback(goal.goal))
    if goal.goal == 1:
        rospy.sleep(0.3)
        server.set_succeeded()


server = actionlib.SimpleActionServer("work", TestAction, auto_start=False)
server.register_goal_callback(came)
server.register_preempt_callback(lambda: (print("preempt"), server.set_preempted(text="as you like")))
server.start()


def waited():
    found = client.wait_for_result(rospy.Duration(3))
    rospy.sleep(0.5)
    print(found)


client = actionlib.SimpleActionClient("work", TestAction)
print(client.wait_for_server())
rospy.sleep(0.5)
client.send_goal(TestGoal(1), feedback_cb=lambda feedback: print("feedback", feedback.feedback))
waited()
print(GoalStatus.to_string(client.get_state()), client.get_result())
client.send_goal(TestGoal(2))
rospy.sleep(0.5)
print(GoalStatus.to_string(client.get_state()))
client.cancel_goal()
waited()
print(GoalStatus.to_string(client.get_state()), client.get_goal_status_text())
print(TestGoal.__slots__, TestAction.__slots__, TestAction._type, TestGoal._md5sum, TestAction._md5sum)
print([GoalStatus.to_string(number) for number in range(10)] if hasattr(GoalStatus, "to_string") else "no names")
for name in ("PENDING", "ACTIVE", "PREEMPTED", "SUCCEEDED", "ABORTED", "REJECTED", "PREEMPTING", "RECALLING", "RECALLED", "LOST"):
    print(name, getattr(GoalStatus, name), end=" ")
print()
