#!/usr/bin/env python3
"""Serves a person at home: brings food, clears the table, looks after the fridge door and the taps of the sink.

    rosrun care_robot robot.py

Hears      /human/command (std_msgs/String), /collision (std_msgs/Bool),
           /mobile_base_controller/odom (nav_msgs/Odometry)
Publishes  /mobile_base_controller/cmd_vel (geometry_msgs/Twist), /robot/status (care_robot/Status)
Uses       MoveIt's group arm_torso, /parallel_gripper_controller/gripper_cmd (control_msgs/GripperCommand),
           /play_motion (play_motion_msgs/PlayMotion)

Each order is a state machine of motions from place to place. The robot goes back to its recharge station after each
order, and when nobody has asked for anything for half a minute.
"""

import queue

import moveit_commander
import rospy
import smach
import smach_ros
from std_msgs.msg import String

from care_robot.arm import Arm, MotionError
from care_robot.base import Base, DriveError
from care_robot.msg import Status

# Where the robot stands, m, and where it looks then, rad.
PLACES = {
    "recharge": (1.35, 0.015, None),
    "fridge": (-2.8, 0.405, 3.1416),
    "sink": (-2.03, 2.95, 1.5708),
    "table": (-2.4, -3.95, 3.1416),
}
CENTRE = (-0.25, -0.5)  # of the room, on the way to and from the table

# Where things stand, m.
FRIDGE_SHELF = [(-3.5, 0.30, 0.66), (-3.5, 0.45, 0.66), (-3.5, 0.60, 0.66)]
TABLE_MEALS = [(-2.92, -4.18, 0.71), (-2.92, -4.04, 0.71), (-3.08, -4.18, 0.71)]
TABLE_DISHES = [(-2.92, -3.80, 0.71), (-3.08, -3.80, 0.71), (-3.08, -3.95, 0.71)]
SINK_BASIN = [(-2.03, 3.5, 0.66), (-1.87, 3.5, 0.66), (-2.19, 3.5, 0.66)]

IDLE_TIME = 30.0  # s


class Robot(object):
    """What the states of all machines share."""

    def __init__(self):
        self.base = Base()
        self.arm = Arm()
        self.at = "recharge"
        self.meals = 0  # taken from the fridge
        self.dishes = 0  # taken from the table
        self.orders = queue.Queue()
        self.status = rospy.Publisher("/robot/status", Status, queue_size=5)
        rospy.Subscriber("/human/command", String, self.on_command)

    def on_command(self, message):
        rospy.loginfo("heard: %s", message.data)
        self.orders.put(message.data)

    def tell(self, state, of=""):
        self.status.publish(state=state, of=of)

    def go(self, place):
        """Drives to a place, by the centre of the room to and from the table, and turns to what stands there."""
        self.tell("moving", place)
        if "table" in (self.at, place):
            self.base.drive_to(CENTRE)
        x, y, heading = PLACES[place]
        self.at = None
        self.base.drive_to((x, y))
        self.at = place
        self.tell("arrived", place)
        if heading is not None:
            self.base.turn_to(heading)


class GoTo(smach.State):
    """Drives to a place."""

    def __init__(self, robot, place):
        smach.State.__init__(self, outcomes=["reached", "failed"])
        self.robot = robot
        self.place = place

    def execute(self, userdata):
        try:
            self.robot.go(self.place)
            self.work()
        except (DriveError, MotionError) as error:
            rospy.logerr("%s: %s", self.place, error)
            return "failed"
        return "reached"

    def work(self):
        """What is done there."""
        rospy.sleep(1.0)


class Grab(smach.State):
    """Takes something in the hand."""

    def __init__(self, robot, kind):
        smach.State.__init__(self, outcomes=["grabbed", "failed"])
        self.robot = robot
        self.kind = kind

    def execute(self, userdata):
        try:
            self.robot.arm.pick(self.next_thing(), self.robot.base.pose())
        except (IndexError, MotionError) as error:
            rospy.logerr("no %s: %s", self.kind, error)
            self.robot.arm.retreat()
            return "failed"
        return "grabbed"

    def next_thing(self):
        """Where the next meal, or dish, stands."""
        robot = self.robot
        if self.kind == "meal":
            robot.meals += 1
            return FRIDGE_SHELF[robot.meals - 1]
        robot.dishes += 1
        return TABLE_DISHES[robot.dishes - 1]


class Serve(GoTo):
    """Brings the meal to the table, and puts it before the person."""

    def work(self):
        self.robot.arm.place(TABLE_MEALS[self.robot.meals - 1])


class Drop(smach.State):
    """Puts the dish into the sink."""

    def __init__(self, robot):
        smach.State.__init__(self, outcomes=["dropped", "failed"])
        self.robot = robot

    def execute(self, userdata):
        try:
            self.robot.arm.place(SINK_BASIN[self.robot.dishes - 1])
        except MotionError as error:
            rospy.logerr("the sink: %s", error)
            return "failed"
        return "dropped"


class Stay(smach.State):
    """Does not understand, and does not move."""

    def __init__(self, robot):
        smach.State.__init__(self, outcomes=["stayed"])
        self.robot = robot

    def execute(self, userdata):
        rospy.logwarn("an order that is not known")
        self.robot.tell("stayed")
        return "stayed"


class Done(smach.State):
    """Tells that an order was obeyed."""

    def __init__(self, robot, order):
        smach.State.__init__(self, outcomes=["done"])
        self.robot = robot
        self.order = order

    def execute(self, userdata):
        if self.order is not None:
            self.robot.tell("completed", self.order)
        return "done"


def machine(steps):
    """A machine of states one after the other."""
    result = smach.StateMachine(outcomes=["completed", "aborted"])
    labels = [label for label, _, _ in steps[1:]] + ["completed"]
    with result:
        for (label, state, outcome), following in zip(steps, labels):
            transitions = {outcome: following}
            if "failed" in state.get_registered_outcomes():
                transitions["failed"] = "aborted"
            smach.StateMachine.add(label, state, transitions=transitions)
    return result


def feed(robot):
    return machine([
        ("FRIDGE", GoTo(robot, "fridge"), "reached"),
        ("GRAB", Grab(robot, "meal"), "grabbed"),
        ("TABLE", Serve(robot, "table"), "reached"),
        ("RECHARGE", GoTo(robot, "recharge"), "reached"),
        ("DONE", Done(robot, "feed"), "done"),
    ])


def clean(robot):
    return machine([
        ("TABLE", GoTo(robot, "table"), "reached"),
        ("GRAB", Grab(robot, "dish"), "grabbed"),
        ("SINK", GoTo(robot, "sink"), "reached"),
        ("DROP", Drop(robot), "dropped"),
        ("RECHARGE", GoTo(robot, "recharge"), "reached"),
        ("DONE", Done(robot, "clean"), "done"),
    ])


def check(robot, place):
    return machine([
        (place.upper(), GoTo(robot, place), "reached"),
        ("RECHARGE", GoTo(robot, "recharge"), "reached"),
        ("DONE", Done(robot, place), "done"),
    ])


def stay(robot):
    return machine([
        ("STAY", Stay(robot), "stayed"),
        ("DONE", Done(robot, None), "done"),
    ])


def serve(robot):
    """Obeys orders, one after the other."""
    machines = {
        "feed": feed(robot),
        "clean": clean(robot),
        "fridge": check(robot, "fridge"),
        "sink": check(robot, "sink"),
    }
    other = stay(robot)
    for name, watched in list(machines.items()) + [("other", other)]:
        smach_ros.IntrospectionServer(name, watched, "/" + name).start()
    while not rospy.is_shutdown():
        robot.tell("idle")
        order = next_order(robot)
        if order is None:
            continue
        outcome = machines.get(order, other).execute()
        rospy.loginfo("%s: %s", order, outcome)


def next_order(robot):
    """What the person wants; goes to the recharge station if it is nothing for long."""
    while not rospy.is_shutdown():
        try:
            return robot.orders.get(timeout=IDLE_TIME)
        except queue.Empty:
            if robot.at != "recharge":
                rospy.loginfo("nobody asks for anything")
                try:
                    robot.go("recharge")
                except DriveError as error:
                    rospy.logerr("recharge: %s", error)
    return None


if __name__ == "__main__":
    moveit_commander.roscpp_initialize([])
    rospy.init_node("robot")
    try:
        serve(Robot())
    except rospy.ROSInterruptException:
        rospy.loginfo("interrupted")
