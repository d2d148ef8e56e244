#!/usr/bin/env python3
"""Hands the four legs of a table to a person, one at a time.

The person asks for a leg by voice. The robot takes one from its stand, holds it out, and announces it. When the person
says that they are ready, it reads three sensors (gaze, grip pressure, place of the hand), and lets go of the leg only if
all three say so; otherwise it puts the leg aside.
"""

import argparse
import logging
import random
import sys

import hrdsl

from fsm import InvalidTransition, State, StateMachine, UserData

log = logging.getLogger("robot")

# ---------------------------------------------------------------------------------------------------------------------
# Configuration
# ---------------------------------------------------------------------------------------------------------------------

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
VOICE_WAIT = VOICE_POLLS * POLL_PERIOD
SETTLE = 0.5
PAUSE_BEFORE_SENSING = 2.0
SENSOR_WAIT = 0.5
SENSING_WINDOW = (10.0, 100.0)
PAUSE_BEFORE_RELEASE = 1.5
TABLE_ON_TIME = 300.0
MAX_GRASP_ATTEMPTS = 2
MAX_REST_ATTEMPTS = 3

LEGS = len(LEG_PLACES)


class ConfigurationError(Exception):
    """A constant above makes no sense."""


class MotionError(Exception):
    """The arm did not reach the place it was sent to."""


def above(place, height):
    """The point at a height above a place."""
    x, y, z = place
    return (x, y, z + height)


def check_configuration():
    """Refuses to start with times that cannot work."""
    low, high = SENSING_WINDOW
    if not 0.0 < low <= high:
        raise ConfigurationError("sensing window %s..%s s" % (low, high))
    if PAUSE_BEFORE_SENSING >= low:
        raise ConfigurationError("the pause leaves no time for sensing")


# ---------------------------------------------------------------------------------------------------------------------
# Hardware
# ---------------------------------------------------------------------------------------------------------------------


class Robot:
    """Arm, gripper, voice and sensors behind one interface."""

    def __init__(self, node):
        self.node = node
        self.arm = node.arm("robot.arm")
        self.gripper = node.gripper("robot.grip")

    def go(self, place, speed=CARRY_SPEED):
        """Moves the hand to a place, or raises `MotionError`."""
        if not self.arm.move_to(place, speed=speed):
            raise MotionError("cannot reach %s: %s" % (place, self.arm.last_error))

    def rest(self):
        """Folds the arm; whether it arrived."""
        return self.arm.move_joints(REST_POSTURE, speed=CARRY_SPEED)

    def open(self):
        if not self.gripper.open():
            log.warning("the gripper does not confirm that it is open")

    def close(self):
        """Closes around whatever is there; whether something is held."""
        held = self.gripper.close()
        self.node.sleep(SETTLE)
        return held

    def hear(self, command):
        """Listens for a voice command; whether it came."""
        heard = self.node.wait_for(command, timeout=VOICE_WAIT)
        if heard is None:
            return False
        log.info("heard %s at %.2f s", heard.name, heard.time)
        return True


# ---------------------------------------------------------------------------------------------------------------------
# Bookkeeping
# ---------------------------------------------------------------------------------------------------------------------


class Statistics:
    """What happened in this run, for the log."""

    def __init__(self, start):
        self.start = start
        self.released = 0
        self.discarded = 0
        self.timeouts = {"leg": 0, "ready": 0, "sensors": 0}
        self.failures = 0
        self.decisions = []

    @property
    def legs(self):
        return self.released + self.discarded

    def report(self, now):
        """Writes the summary to the log."""
        log.info("legs handled: %d (released %d, discarded %d)", self.legs, self.released, self.discarded)
        log.info("decisions: %d (ready %d), failed motions: %d", len(self.decisions), sum(self.decisions), self.failures)
        for what, count in self.timeouts.items():
            if count:
                log.info("timeouts while waiting for %s: %d", what, count)
        if self.released == LEGS:
            verdict = "on time" if now - self.start <= TABLE_ON_TIME else "late"
            log.info("table done in %.1f s, %s", now - self.start, verdict)
        else:
            log.info("table not complete: %d legs are missing", LEGS - self.released)


# ---------------------------------------------------------------------------------------------------------------------
# States
# ---------------------------------------------------------------------------------------------------------------------


class RobotState(State):
    """A state that works with the robot's hardware."""

    outcomes_of = ()

    def __init__(self, robot):
        super().__init__(self.outcomes_of)
        self.robot = robot
        self.node = robot.node

    def log(self, text, *args):
        log.info("[%8.2f] %s: " + text, self.node.now(), type(self).__name__, *args)


class Reset(RobotState):
    """Back to the rest posture with an open hand; the end when all legs are dealt with."""

    outcomes_of = ("ready", "all_done", "stuck")

    def execute(self, userdata):
        for attempt in range(MAX_REST_ATTEMPTS):
            if self.robot.rest():
                break
            log.warning("attempt %d to rest failed: %s", attempt + 1, self.robot.arm.last_error)
            userdata.statistics.failures += 1
        else:
            return "stuck"
        self.robot.open()
        self.node.drop("human_ready", "sensed")
        userdata.readings = None
        userdata.attempts = 0
        if userdata.statistics.legs >= LEGS:
            return "all_done"
        self.log("waiting for leg %d of %d", userdata.statistics.legs + 1, LEGS)
        return "ready"


class Receive1(RobotState):
    """Waits for the person to ask for a leg."""

    outcomes_of = ("requested", "timeout")

    def execute(self, userdata):
        return "requested" if self.robot.hear("leg_request") else "timeout"


class Timeout1(RobotState):
    """Nobody asked: listen again."""

    outcomes_of = ("again",)

    def execute(self, userdata):
        userdata.statistics.timeouts["leg"] += 1
        return "again"


class Move(RobotState):
    """Fetches the next leg and holds it out."""

    outcomes_of = ("holding", "nothing_held", "unreachable")

    def execute(self, userdata):
        place = LEG_PLACES[userdata.statistics.legs]
        userdata.attempts += 1
        self.log("fetching the leg at (%.2f, %.2f, %.2f)", *place)
        try:
            self.robot.open()
            self.robot.go(above(place, APPROACH_HEIGHT))
            self.robot.go(place, APPROACH_SPEED)
            held = self.robot.close()
            self.robot.go(above(place, LIFT_HEIGHT), APPROACH_SPEED)
            if not held:
                self.log("the hand is empty after attempt %d", userdata.attempts)
                if userdata.attempts < MAX_GRASP_ATTEMPTS:
                    return "nothing_held"
                return "unreachable"
            self.robot.go(HANDOVER_PLACE)
        except MotionError as error:
            log.error("%s", error)
            userdata.statistics.failures += 1
            return "unreachable"
        return "holding"


class Send(RobotState):
    """Announces the leg."""

    outcomes_of = ("announced",)

    def execute(self, userdata):
        self.node.drop("human_ready")
        self.node.emit("handover_offered")
        userdata.sense_until = self.node.now() + userdata.window
        self.log("offered; sensing is possible until %.1f s", userdata.sense_until)
        return "announced"


class Receive2(RobotState):
    """Waits for the person to say that they are ready."""

    outcomes_of = ("ready", "timeout")

    def execute(self, userdata):
        return "ready" if self.robot.hear("human_ready") else "timeout"


class Timeout2(RobotState):
    """The person did not answer: the leg is put aside."""

    outcomes_of = ("give_up",)

    def execute(self, userdata):
        userdata.statistics.timeouts["ready"] += 1
        self.node.emit("timed_out")
        self.log("nobody is ready")
        return "give_up"


class Wait(RobotState):
    """Gives the person time to take hold."""

    outcomes_of = ("waited",)

    def execute(self, userdata):
        self.node.sleep(PAUSE_BEFORE_SENSING)
        return "waited"


class Sense(RobotState):
    """Asks the sensors until they answer or the window has closed."""

    outcomes_of = ("sensed", "timeout")

    def execute(self, userdata):
        self.node.drop("sensed")
        while self.node.now() < userdata.sense_until:
            self.node.emit("sense")
            answer = self.node.wait_for("sensed", timeout=SENSOR_WAIT)
            if answer is None:
                continue
            userdata.readings = {
                "gaze": answer.gaze,
                "pressure": answer.pressure,
                "location": answer.location,
            }
            return "sensed"
        return "timeout"


class Timeout3(RobotState):
    """The sensors did not answer in time."""

    outcomes_of = ("give_up",)

    def execute(self, userdata):
        userdata.statistics.timeouts["sensors"] += 1
        self.node.emit("timed_out")
        self.log("the sensing window of %.1f s has closed", userdata.window)
        return "give_up"


class Decide(RobotState):
    """Ready only if gaze, pressure and location all say so."""

    outcomes_of = ("human_ready", "human_not_ready")

    def execute(self, userdata):
        readings = userdata.readings
        ready = readings["gaze"] and readings["pressure"] and readings["location"]
        userdata.statistics.decisions.append(ready)
        self.node.emit("decided", ready=ready)
        if ready:
            self.log("the person is ready")
            return "human_ready"
        missing = ", ".join(name for name, value in readings.items() if not value)
        self.log("the person is not ready: %s", missing)
        return "human_not_ready"


class Release(RobotState):
    """Lets go of the leg once the person is felt to hold it."""

    outcomes_of = ("released",)

    def execute(self, userdata):
        self.node.sleep(PAUSE_BEFORE_RELEASE)
        self.wait_for_hold(userdata.sense_until)
        self.robot.open()
        self.node.emit("released")
        userdata.statistics.released += 1
        self.log("leg %d released", userdata.statistics.legs)
        return "released"

    def wait_for_hold(self, until):
        """A leg that nobody holds falls on somebody's foot: wait for the grip, within the time for sensing."""
        while not self.node.read("pressure"):
            if self.node.now() >= until:
                log.warning("no grip is felt, the time is up")
                return
            self.node.sleep(POLL_PERIOD)


class Discard(RobotState):
    """Puts the leg aside."""

    outcomes_of = ("discarded",)

    def execute(self, userdata):
        try:
            self.robot.go(DISCARD_PLACE)
        except MotionError as error:
            log.error("%s; the leg is dropped here", error)
            userdata.statistics.failures += 1
        self.robot.open()
        self.node.emit("discarded")
        userdata.statistics.discarded += 1
        self.log("leg %d discarded", userdata.statistics.legs)
        return "discarded"


class Done(RobotState):
    """All legs are dealt with."""

    outcomes_of = ("finished",)

    def execute(self, userdata):
        userdata.statistics.report(self.node.now())
        return "finished"


# ---------------------------------------------------------------------------------------------------------------------
# The machine
# ---------------------------------------------------------------------------------------------------------------------


def build(robot):
    """The machine: 14 states, 22 transitions."""
    machine = StateMachine(outcomes=["finished"])
    machine.add("Reset", Reset(robot), {"ready": "Receive1", "all_done": "Done", "stuck": "Done"})
    machine.add("Receive1", Receive1(robot), {"requested": "Move", "timeout": "Timeout1"})
    machine.add("Timeout1", Timeout1(robot), {"again": "Receive1"})
    machine.add("Move", Move(robot), {"holding": "Send", "nothing_held": "Move", "unreachable": "Discard"})
    machine.add("Send", Send(robot), {"announced": "Receive2"})
    machine.add("Receive2", Receive2(robot), {"ready": "Wait", "timeout": "Timeout2"})
    machine.add("Timeout2", Timeout2(robot), {"give_up": "Discard"})
    machine.add("Wait", Wait(robot), {"waited": "Sense"})
    machine.add("Sense", Sense(robot), {"sensed": "Decide", "timeout": "Timeout3"})
    machine.add("Timeout3", Timeout3(robot), {"give_up": "Discard"})
    machine.add("Decide", Decide(robot), {"human_ready": "Release", "human_not_ready": "Discard"})
    machine.add("Release", Release(robot), {"released": "Reset"})
    machine.add("Discard", Discard(robot), {"discarded": "Reset"})
    machine.add("Done", Done(robot), {"finished": "finished"})
    return machine


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(description="Hands table legs to a person.")
    parser.add_argument("--window", type=float, help="seconds in which the sensors must answer (default: drawn)")
    parser.add_argument("--verbose", action="store_true", help="log every transition and motion")
    return parser.parse_args(arguments)


def main(arguments=None):
    options = parse_arguments(arguments)
    logging.basicConfig(
        stream=sys.stdout,
        level=logging.DEBUG if options.verbose else logging.INFO,
        format="%(levelname)s %(name)s %(message)s",
    )
    try:
        check_configuration()
    except ConfigurationError as error:
        log.error("bad configuration: %s", error)
        return 2
    node = hrdsl.Node("robot")
    window = options.window
    if window is None:
        window = random.uniform(*SENSING_WINDOW)
    log.info("sensing window of this run: %.1f s", window)
    userdata = UserData(statistics=Statistics(node.now()), window=window, sense_until=0.0)
    try:
        outcome = build(Robot(node)).execute(userdata)
    except (InvalidTransition, hrdsl.ProtocolError) as error:
        log.error("stopped: %s", error)
        userdata.statistics.report(node.now())
        return 1
    log.info("outcome: %s", outcome)
    return 0


if __name__ == "__main__":
    sys.exit(main())
