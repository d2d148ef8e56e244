"""A goal that is cancelled, one that is replaced, and one for which nobody waits to the end."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal, TestResult
from actionlib_msgs.msg import GoalStatus

rospy.init_node("action_preempt")


def execute(goal):
    print("begin", goal.goal)
    for _ in range(15):
        if server.is_preempt_requested():
            rospy.sleep(0.25)
            print("preempted", goal.goal, server.is_new_goal_available())
            server.set_preempted(TestResult(goal.goal), "stopped")
            return
        rospy.sleep(0.1)
    server.set_succeeded(TestResult(goal.goal))


server = actionlib.SimpleActionServer("work", TestAction, execute, False)
server.register_preempt_callback(lambda: print("preempt callback"))
server.start()
client = actionlib.SimpleActionClient("work", TestAction)
client.wait_for_server()
rospy.sleep(0.5)


def waited(seconds):
    found = client.wait_for_result(rospy.Duration(seconds))
    rospy.sleep(0.5 if found else 0)
    print(found)


def shown(text):
    result = client.get_result()
    print(text, GoalStatus.to_string(client.get_state()), client.get_goal_status_text(), None if result is None else result.result)


client.send_goal(TestGoal(1))
rospy.sleep(0.45)
shown("running")
client.cancel_goal()
waited(3)
shown("cancelled")
client.send_goal(TestGoal(2), lambda state, result: print("never done"))
rospy.sleep(0.45)
client.send_goal(TestGoal(3), lambda state, result: print("done", GoalStatus.to_string(state), result.result))
waited(4)
rospy.sleep(0.3)
shown("replaced")
client.send_goal(TestGoal(4))
waited(0.35)
shown("not waited for")
client.cancel_all_goals()
waited(3)
shown("all cancelled")
state = client.send_goal_and_wait(TestGoal(5), rospy.Duration(0.5), rospy.Duration(1))
rospy.sleep(0.5)
print(GoalStatus.to_string(state))
shown("given up")
state = client.send_goal_and_wait(TestGoal(6), rospy.Duration(4))
rospy.sleep(0.5)
print(GoalStatus.to_string(state))
shown("sent and waited")
client.stop_tracking_goal()
print(client.wait_for_result(rospy.Duration(0.1)), client.get_result())
rospy.signal_shutdown("the execute thread waits for the end")
