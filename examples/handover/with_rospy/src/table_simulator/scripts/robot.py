#!/usr/bin/env python3
"""Hands the four legs of a table to a person, one at a time.

    rosrun table_simulator robot.py [WINDOW]

The person asks for a leg by voice. The robot takes one from its stand, holds it out, and announces it. When the person
says that they are ready, it reads three sensors (gaze, grip pressure, place of the hand), and lets go of the leg only if
all three say so; otherwise it puts the leg aside. WINDOW is the time in seconds in which the sensors must answer; without
it, it is drawn.
"""

import random
import sys
import time

import moveit_commander
import rospy
import smach
import smach_ros
from std_msgs.msg import Bool, String

from hardware import Arm, Ears, Gripper, MotionError, Sensors

# Places in metres, from the robot's base.
LEG_PLACES = (
    (0.3, -0.30, 0.5555),
    (0.3, -0.38, 0.5555),
    (0.3, -0.46, 0.5555),
    (0.3, -0.54, 0.5555),
)
HANDOVER_PLACE = (0.48, 0.17, 1.1)
DISCARD_PLACE = (0.15, 0.45, 0.65)
APPROACH_HEIGHT = 0.12
LIFT_HEIGHT = 0.12

REST_POSTURE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # radians, from hip to wrist
CARRY_SPEED = 0.2  # rad/s; the limit for work near people is 0.25 rad/s
APPROACH_SPEED = 0.15

# Times in seconds.
POLL_PERIOD = 0.05
VOICE_POLLS = 60
SETTLE = 0.5
PAUSE_BEFORE_SENSING = 2.0
SENSOR_WAIT = 0.5
SENSING_WINDOW = (10.0, 100.0)
PAUSE_BEFORE_RELEASE = 1.5
TABLE_ON_TIME = 300.0
MAX_GRASP_ATTEMPTS = 2
MAX_REST_ATTEMPTS = 3

LEGS = len(LEG_PLACES)
OFFER = "your leg, please"


def above(place, height):
    """The point at a height above a place."""
    x, y, z = place
    return (x, y, z + height)


class Robot(object):
    """Arm, gripper, ears, sensors and voice."""

    def __init__(self):
        self.arm = Arm("body_arm")
        self.gripper = Gripper("/gripper_controller/gripper_cmd")
        self.ears = Ears()
        self.sensors = Sensors()
        self.speech = rospy.Publisher("/robot/speech", String, queue_size=1, latch=True)
        self.decision = rospy.Publisher("/robot/human_is_ready", Bool, queue_size=1, latch=True)

    def go(self, place, speed=CARRY_SPEED):
        """Moves the hand to a place, or raises `MotionError`."""
        self.arm.move_to(place, speed)

    def open(self):
        if not self.gripper.open():
            rospy.logwarn("the gripper does not confirm that it is open")

    def close(self):
        """Closes around whatever is there; whether something is held."""
        held = self.gripper.close()
        rospy.sleep(SETTLE)
        return held

    def hear(self, command):
        """Listens for a voice command; whether it came."""
        said = self.ears.wait_for(command, VOICE_POLLS, POLL_PERIOD)
        if said is None:
            return False
        rospy.loginfo("heard %s, said at %.2f s", command, said.to_sec())
        return True


class Statistics(object):
    """What happened in this run, for the log."""

    def __init__(self):
        self.start = time.time()
        self.released = 0
        self.discarded = 0
        self.timeouts = {"leg": 0, "ready": 0, "sensors": 0}
        self.failures = 0
        self.decisions = []

    @property
    def legs(self):
        return self.released + self.discarded

    def report(self):
        """Writes the summary to the log."""
        took = time.time() - self.start
        rospy.loginfo("legs handled: %d (released %d, discarded %d)", self.legs, self.released, self.discarded)
        rospy.loginfo(
            "decisions: %d (ready %d), failed motions: %d", len(self.decisions), sum(self.decisions), self.failures
        )
        for what, count in self.timeouts.items():
            if count:
                rospy.loginfo("timeouts while waiting for %s: %d", what, count)
        if self.released == LEGS:
            verdict = "on time" if took <= TABLE_ON_TIME else "late"
            rospy.loginfo("table done in %.1f s, %s", took, verdict)
        else:
            rospy.loginfo("table not complete: %d legs are missing", LEGS - self.released)


# ---------------------------------------------------------------------------------------------------------------------
# States
# ---------------------------------------------------------------------------------------------------------------------


class RobotState(smach.State):
    """A state that works with the robot's hardware and keeps the statistics."""

    def __init__(self, robot, statistics, outcomes, input_keys=(), output_keys=()):
        smach.State.__init__(self, outcomes=outcomes, input_keys=list(input_keys), output_keys=list(output_keys))
        self.robot = robot
        self.statistics = statistics


class Reset(RobotState):
    """Back to the rest posture with an open hand; the end when all legs are dealt with."""

    def __init__(self, robot, statistics):
        RobotState.__init__(
            self, robot, statistics, ["ready", "all_done", "stuck"], output_keys=["attempts", "readings"]
        )

    def execute(self, userdata):
        for attempt in range(MAX_REST_ATTEMPTS):
            try:
                self.robot.arm.move_joints(REST_POSTURE, CARRY_SPEED)
                break
            except MotionError as error:
                rospy.logwarn("attempt %d to rest failed: %s", attempt + 1, error)
                self.statistics.failures += 1
        else:
            return "stuck"
        self.robot.open()
        self.robot.ears.forget("human_ready")
        self.robot.sensors.forget()
        userdata.readings = None
        userdata.attempts = 0
        if self.statistics.legs >= LEGS:
            return "all_done"
        rospy.loginfo("waiting for leg %d of %d", self.statistics.legs + 1, LEGS)
        return "ready"


class Receive1(RobotState):
    """Waits for the person to ask for a leg."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["requested", "timeout"])

    def execute(self, userdata):
        return "requested" if self.robot.hear("leg_request") else "timeout"


class Timeout1(RobotState):
    """Nobody asked: listen again."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["again"])

    def execute(self, userdata):
        self.statistics.timeouts["leg"] += 1
        return "again"


class Move(RobotState):
    """Fetches the next leg and holds it out."""

    def __init__(self, robot, statistics):
        outcomes = ["holding", "nothing_held", "unreachable"]
        RobotState.__init__(self, robot, statistics, outcomes, ["attempts"], ["attempts"])

    def execute(self, userdata):
        place = LEG_PLACES[self.statistics.legs]
        userdata.attempts += 1
        rospy.loginfo("fetching the leg at (%.2f, %.2f, %.2f)", *place)
        try:
            self.robot.open()
            self.robot.go(above(place, APPROACH_HEIGHT))
            self.robot.go(place, APPROACH_SPEED)
            held = self.robot.close()
            self.robot.go(above(place, LIFT_HEIGHT), APPROACH_SPEED)
            if not held:
                rospy.loginfo("the hand is empty after attempt %d", userdata.attempts)
                if userdata.attempts < MAX_GRASP_ATTEMPTS:
                    return "nothing_held"
                return "unreachable"
            self.robot.go(HANDOVER_PLACE)
        except MotionError as error:
            rospy.logerr("%s", error)
            self.statistics.failures += 1
            return "unreachable"
        return "holding"


class Send(RobotState):
    """Announces the leg."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["announced"], ["window"], ["sense_until"])

    def execute(self, userdata):
        self.robot.ears.forget("human_ready")
        self.robot.speech.publish(OFFER)
        userdata.sense_until = time.time() + userdata.window
        rospy.loginfo("offered; sensing is possible for %.1f s", userdata.window)
        return "announced"


class Receive2(RobotState):
    """Waits for the person to say that they are ready."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["ready", "timeout"])

    def execute(self, userdata):
        return "ready" if self.robot.hear("human_ready") else "timeout"


class Timeout2(RobotState):
    """The person did not answer: the leg is put aside."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["give_up"])

    def execute(self, userdata):
        self.statistics.timeouts["ready"] += 1
        rospy.loginfo("nobody is ready")
        return "give_up"


class Wait(RobotState):
    """Gives the person time to take hold."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["waited"])

    def execute(self, userdata):
        rospy.sleep(PAUSE_BEFORE_SENSING)
        return "waited"


class Sense(RobotState):
    """Asks the sensors until they answer or the window has closed."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["sensed", "timeout"], ["sense_until"], ["readings"])

    def execute(self, userdata):
        self.robot.sensors.forget()
        while time.time() < userdata.sense_until:
            answer = self.robot.sensors.ask(SENSOR_WAIT)
            if answer is not None:
                userdata.readings = answer
                return "sensed"
        return "timeout"


class Timeout3(RobotState):
    """The sensors did not answer in time."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["give_up"], ["window"])

    def execute(self, userdata):
        self.statistics.timeouts["sensors"] += 1
        rospy.loginfo("the sensing window of %.1f s has closed", userdata.window)
        return "give_up"


class Decide(RobotState):
    """Ready only if gaze, pressure and location all say so."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["human_ready", "human_not_ready"], ["readings"])

    def execute(self, userdata):
        readings = userdata.readings
        ready = readings.gaze and readings.pressure and readings.location
        self.statistics.decisions.append(ready)
        self.robot.decision.publish(ready)
        if ready:
            rospy.loginfo("the person is ready")
            return "human_ready"
        missing = ", ".join(name for name in readings.__slots__ if not getattr(readings, name))
        rospy.loginfo("the person is not ready: %s", missing)
        return "human_not_ready"


class Release(RobotState):
    """Lets go of the leg once the person is felt to hold it."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["released"], ["sense_until"])

    def execute(self, userdata):
        rospy.sleep(PAUSE_BEFORE_RELEASE)
        self.wait_for_hold(userdata.sense_until)
        self.robot.open()
        self.statistics.released += 1
        rospy.loginfo("leg %d released", self.statistics.legs)
        return "released"

    def wait_for_hold(self, until):
        """A leg that nobody holds falls on somebody's foot: wait for the grip, within the time for sensing."""
        while not self.robot.sensors.grip_is_felt():
            if time.time() >= until:
                rospy.logwarn("no grip is felt, the time is up")
                return
            rospy.sleep(POLL_PERIOD)


class Discard(RobotState):
    """Puts the leg aside."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["discarded"])

    def execute(self, userdata):
        try:
            self.robot.go(DISCARD_PLACE)
        except MotionError as error:
            rospy.logerr("%s; the leg is dropped here", error)
            self.statistics.failures += 1
        self.robot.open()
        self.statistics.discarded += 1
        rospy.loginfo("leg %d discarded", self.statistics.legs)
        return "discarded"


class Done(RobotState):
    """All legs are dealt with."""

    def __init__(self, robot, statistics):
        RobotState.__init__(self, robot, statistics, ["finished"])

    def execute(self, userdata):
        self.statistics.report()
        return "finished"


# ---------------------------------------------------------------------------------------------------------------------
# The machine
# ---------------------------------------------------------------------------------------------------------------------

STATES = (
    ("Reset", Reset, {"ready": "Receive1", "all_done": "Done", "stuck": "Done"}),
    ("Receive1", Receive1, {"requested": "Move", "timeout": "Timeout1"}),
    ("Timeout1", Timeout1, {"again": "Receive1"}),
    ("Move", Move, {"holding": "Send", "nothing_held": "Move", "unreachable": "Discard"}),
    ("Send", Send, {"announced": "Receive2"}),
    ("Receive2", Receive2, {"ready": "Wait", "timeout": "Timeout2"}),
    ("Timeout2", Timeout2, {"give_up": "Discard"}),
    ("Wait", Wait, {"waited": "Sense"}),
    ("Sense", Sense, {"sensed": "Decide", "timeout": "Timeout3"}),
    ("Timeout3", Timeout3, {"give_up": "Discard"}),
    ("Decide", Decide, {"human_ready": "Release", "human_not_ready": "Discard"}),
    ("Release", Release, {"released": "Reset"}),
    ("Discard", Discard, {"discarded": "Reset"}),
    ("Done", Done, {"finished": "finished"}),
)


def build(robot, statistics, window):
    """The machine: 14 states, 22 transitions."""
    machine = smach.StateMachine(outcomes=["finished"])
    machine.userdata.window = window
    machine.userdata.sense_until = 0.0
    machine.userdata.attempts = 0
    machine.userdata.readings = None
    with machine:
        for label, state, transitions in STATES:
            smach.StateMachine.add(label, state(robot, statistics), transitions=transitions)
    return machine


def main():
    moveit_commander.roscpp_initialize(sys.argv)
    rospy.init_node("robot")
    arguments = rospy.myargv(sys.argv)[1:]
    window = float(arguments[0]) if arguments else random.uniform(*SENSING_WINDOW)
    rospy.loginfo("sensing window of this run: %.1f s", window)
    statistics = Statistics()
    machine = build(Robot(), statistics, window)
    introspection = smach_ros.IntrospectionServer("table", machine, "/TABLE")  # for smach_viewer
    introspection.start()
    outcome = machine.execute()
    introspection.stop()
    rospy.loginfo("outcome: %s", outcome)


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
