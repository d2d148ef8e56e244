#!/usr/bin/env python3
"""Takes a parcel to whoever calls for it, and comes home.

    rosrun courier mission.py

Hears      /panel/call (courier/Call), /tray/hand (std_msgs/Bool)
Publishes  /panel/status (courier/Status), latched
Uses       /driver/drive_to (courier/DriveTo), /driver/enable (std_srvs/SetBool), /driver/clearance (courier/Clearance),
           /horn/sound (std_srvs/Trigger)
Parameters ~desks, ~dock, ~taking_time, ~horn_delay
"""

import threading

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger

from courier.msg import Call, DriveToAction, DriveToGoal, Status
from courier.srv import Clearance

DESKS = {"mail": [5.0, 0.3], "lab": [7.0, -0.3]}  # m, in the frame "odom"
DOCK = [0.0, 0.0]
FREE = 1.0  # m, in front of the dock
HOME_ATTEMPTS = 2


class Mission(object):
    """One trip at a time, in the main thread; callbacks leave word for it."""

    def __init__(self):
        self.desks = rospy.get_param("~desks", DESKS)
        self.dock = rospy.get_param("~dock", DOCK)
        self.taking_time = rospy.Duration(rospy.get_param("~taking_time", 15.0))
        self.horn_delay = rospy.Duration(rospy.get_param("~horn_delay", 2.0))

        self.lock = threading.Lock()
        self.called = threading.Condition(self.lock)
        self.desk = None  # of the trip that is under way
        self.cancelled = False
        self.handed = False  # a hand was in the tray
        self.blocked_since = None
        self.asked = False

        self.status = rospy.Publisher("/panel/status", Status, queue_size=5, latch=True)
        self.driver = actionlib.SimpleActionClient("/driver/drive_to", DriveToAction)
        self.enable = self.service("/driver/enable", SetBool)
        self.clearance = self.service("/driver/clearance", Clearance)
        self.horn = self.service("/horn/sound", Trigger)
        if not self.driver.wait_for_server(rospy.Duration(10.0)):
            rospy.logfatal("there is no driver")
            raise rospy.ROSInitException("no driver")
        rospy.Subscriber("/tray/hand", Bool, self.on_hand)
        rospy.Subscriber("/panel/call", Call, self.on_call)
        rospy.on_shutdown(self.driver.cancel_all_goals)

    @staticmethod
    def service(name, service_class):
        rospy.wait_for_service(name, timeout=10.0)
        return rospy.ServiceProxy(name, service_class)

    # -- what it hears ------------------------------------------------------------------------------------------------

    def on_call(self, message):
        with self.lock:
            if message.cancel:
                if self.desk is not None:
                    rospy.loginfo("the call is taken back")
                    self.cancelled = True
            elif message.desk not in self.desks:
                rospy.logerr("there is no desk %s", message.desk)
            elif self.desk is not None:
                self.tell("sorry", message.desk, "busy")
            else:
                self.desk = message.desk
                self.called.notify()

    def on_hand(self, message):
        with self.lock:
            self.handed = self.handed or message.data

    def on_feedback(self, feedback):
        """Whoever is in the way for a while is asked to step aside."""
        now = rospy.Time.now()
        if not feedback.blocked:
            self.blocked_since = None
        elif self.blocked_since is None:
            self.blocked_since = now
        elif not self.asked and now - self.blocked_since >= self.horn_delay:
            self.ask()

    def ask(self):
        self.asked = True
        try:
            self.horn()
        except rospy.ServiceException as error:
            rospy.logerr("the horn is broken: %s", error)

    def tell(self, state, desk, reason=""):
        rospy.loginfo("%s: %s %s", desk, state, reason)
        self.status.publish(state=state, desk=desk, reason=reason)

    # -- what it does -------------------------------------------------------------------------------------------------

    def run(self):
        while not rospy.is_shutdown():
            with self.called:
                while self.desk is None and not rospy.is_shutdown():
                    self.called.wait(1.0)
                desk = self.desk
            if desk is not None:
                self.trip(desk)
                with self.lock:
                    self.desk, self.cancelled = None, False

    def trip(self, desk):
        """To a desk and back."""
        self.tell("coming", desk)
        self.leave()
        self.enable(True)
        reason = self.drive(self.desks[desk], lambda: self.cancelled)
        if not reason:
            reason = self.hand_over(desk)
        if reason:
            self.tell("sorry", desk, reason)
        else:
            self.tell("delivered", desk)
        self.go_home(desk)
        self.enable(False)

    def leave(self):
        """Does not set out into somebody who stands in front of the dock: asks, and waits a little."""
        answer = self.clearance()
        if answer.known and answer.distance < FREE:
            self.ask()
            rospy.sleep(3.0)

    def drive(self, place, cancelled):
        """Drives to a place; why it is not there, or nothing."""
        goal = DriveToGoal()
        goal.target.x, goal.target.y = place
        self.asked = False
        self.blocked_since = None
        self.driver.send_goal(goal, feedback_cb=self.on_feedback)
        while not self.driver.wait_for_result(rospy.Duration(0.2)):
            if rospy.is_shutdown():
                return "cancelled"
            if cancelled():
                self.driver.cancel_goal()
        if cancelled():
            return "cancelled"  # perhaps it has just arrived
        if self.driver.get_state() == GoalStatus.SUCCEEDED:
            return ""
        return self.driver.get_result().reason

    def hand_over(self, desk):
        """Waits until somebody has reached into the tray; why nobody has, or nothing."""
        self.tell("arrived", desk)
        with self.lock:
            self.handed = False
        rate = rospy.Rate(5)
        until = rospy.Time.now() + self.taking_time
        while not rospy.is_shutdown() and rospy.Time.now() < until:
            with self.lock:
                if self.handed:
                    return ""
                if self.cancelled:
                    return "cancelled"
            rate.sleep()
        return "nobody"

    def go_home(self, desk):
        for _ in range(HOME_ATTEMPTS):
            reason = self.drive(self.dock, lambda: False)
            if not reason:
                self.tell("home", desk)
                return
            rospy.logwarn("not home: %s", reason)
        self.tell("stuck", desk, reason)


if __name__ == "__main__":
    rospy.init_node("mission")
    try:
        Mission().run()
    except rospy.ROSInterruptException:
        rospy.loginfo("interrupted")
