"""Uses everything that is bound, and prints what it sees."""

import actionlib
import rospy
import smach
from geometry_msgs.msg import PointStamped
from play_motion_msgs.msg import PlayMotionAction, PlayMotionGoal
from std_msgs.msg import Bool, Float64, Int8
from std_srvs.srv import SetBool


def show(text, *args):
    print("%.3f %s" % (rospy.get_time() - 1735689600, text % args))


class Work(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["done"])

    def execute(self, userdata):
        return "done"


class Rest(Work):
    pass


rospy.init_node("brain")
ok = rospy.Publisher("/ok", Int8, queue_size=1)
said = rospy.Publisher("/said", Int8, queue_size=1)
hip = rospy.Publisher("/arm/hip_rotor/command", Float64, queue_size=1)
nobody = rospy.Publisher("/arm/no_such_joint/command", Float64, queue_size=1)
heard = []


def human(message):
    ok.publish(1 if message.data else 0)
    if message.data != (heard and heard[-1]):
        heard.append(message.data)
        show("human %s", message.data)


def order(message):
    show("order %d", message.data)
    ok.publish(message.data)
    said.publish(message.data)


rospy.Subscriber("/human", Bool, human)
rospy.Subscriber("/orders", Int8, order)
rospy.Subscriber("/again", Int8, lambda message: show("again %d", message.data))
place = rospy.wait_for_message("/hand", PointStamped)
show("hand %s %.1f at %.1f", place.header.frame_id, place.point.z, place.header.stamp.to_sec() - 1735689600)
hip.publish(0.1)
nobody.publish(0.1)
rospy.wait_for_service("/grip")
grip = rospy.ServiceProxy("/grip", SetBool)
show("grip %s", grip(True).message)
client = actionlib.SimpleActionClient("/play", PlayMotionAction)
client.wait_for_server()
for motion in ("stop", "dance"):
    client.send_goal_and_wait(PlayMotionGoal(motion_name=motion))
    show("motion %s: state %d", motion, client.get_state())
machine = smach.StateMachine(outcomes=["over"])
with machine:
    smach.StateMachine.add("Work", Work(), transitions={"done": "Rest"})
    smach.StateMachine.add("Rest", Rest(), transitions={"done": "over"})
show("machine %s", machine.execute())
print("graph", sorted(name for name, _ in rospy.get_published_topics()))
rospy.spin()
