"""`moveit_commander` with an arm that follows what it is told: plans, motions, targets and what is refused."""

import unittest

from system import Refused, System
from tables import run_ros

SECOND = 10**9

GROUPS = {
    "arm": {
        "device": "robot.arm",
        "joints": [
            {"name": "shoulder", "lower": -2.0, "upper": 2.0, "velocity": 1.0},
            {"name": "elbow", "lower": -1.5, "upper": 1.5, "velocity": 0.5},
        ],
        "states": {"home": [0, 0], "up": {"shoulder": 1.0, "elbow": -0.5}},
        "tip": "hand",
    }
}

IMPORTS = """
import sys
import rospy, moveit_commander
from moveit_commander import MoveItCommanderException

def say(*what):
    print("%.3f" % (rospy.get_time() - 1735689600), *what)

def near(numbers):
    return [round(number, 6) + 0.0 for number in numbers]

def tries(*calls):
    for call in calls:
        try:
            call()
        except (MoveItCommanderException, NotImplementedError, RuntimeError) as error:
            print(type(error).__name__, error)

moveit_commander.roscpp_initialize(sys.argv)
rospy.init_node("mover")
"""


class Arm(System):
    """An arm that is where its trajectory ends, when that has ended."""

    def __init__(self, tool=True, **how):
        super().__init__(commands=self._command, states={"robot.arm": [0.0, 0.0]}, **how)
        self._tool, self.followed, self._last = tool, [], None

    def do_state(self, request):
        if request["what"] == "joints":
            return super().do_state(request)
        if not self._tool:
            raise Refused("no state `tool` of robot.arm")
        return {"value": [0.5, 0.0, 0.25, 0.0, 0.0, 0.479425538604203, 0.8775825618903728]}

    def do_plan(self, request):
        x, y = request["joints"] if "joints" in request else request["to"][:2]
        if x > 1 and "to" in request:
            return {"ok": False, "error": "the place is out of reach"}
        return self._timed(request, [x, y]) if request.get("timed") else {"value": [x, y]}

    def _timed(self, request, end):
        """A way by its begin, its middle and its end; it takes the time of both ramps more than without them."""
        begin = request.get("from", self.states["robot.arm"])
        apart = [b - a for a, b in zip(begin, end)]
        length = max(abs(change) / speed for change, speed in zip(apart, request["speeds"]))
        if not length:
            return {"value": end, "velocities": [0.0, 0.0], "accelerations": [0.0, 0.0], "times": [0.0]}
        rise = max(abs(change) / most for change, most in zip(apart, request["accelerations"])) / length
        middle, speeds = [a + change / 2 for a, change in zip(begin, apart)], [change / length for change in apart]
        return {
            "value": [*begin, *middle, *end],
            "velocities": [0.0, 0.0, *speeds, 0.0, 0.0],
            "accelerations": [change / length / rise for change in apart] + [0.0] * 4,
            "times": [0.0, (length + rise) / 2, length + rise],
        }

    def _command(self, request):
        if request["do"] != "follow":
            raise Refused("no command `%s` of robot.arm" % request["do"])
        if self._last is not None and self._last["until"] > self.time:
            ended = {"ended": self._last["call"], "ok": False, "error": "another command was given"}
            self._queue = [entry for entry in self._queue if entry[2].get("ended") != self._last["call"]]
            self.mailbox.append(ended)
        args = request["args"]
        self.followed.append((self.time, args))
        delay = round(args["times"][-1] * SECOND)
        self._last = {"call": request["call"], "until": self.time + delay}
        if args["positions"][-2:] == [-2.0, 0.0]:
            return delay // 2, "it hit something"
        self.later(self.time + delay, lambda _: self.states.update({"robot.arm": args["positions"][-2:]}))
        return delay, None

    def later(self, time, arrival):
        super().later(time, _Step(arrival) if callable(arrival) else arrival)


class _Step(dict):
    """Something to be done, that also has no `ended`."""

    def __init__(self, function):
        super().__init__()
        self._function = function

    def __call__(self, system):
        self._function(system)


class Case(unittest.TestCase):
    def said(self, text, system=None, **keys):
        system = system or Arm()
        packages = ["geometry_msgs", "moveit_msgs", "sensor_msgs", "shape_msgs", "trajectory_msgs", "std_msgs"]
        binding = {"groups": GROUPS, "base_frame": "base", "frames": ["base", "link"], **keys}
        done = run_ros(IMPORTS + text, packages, system, binding=binding)
        self.assertEqual(done.code, 0, done.err)
        self.out, self.err, self.requests = done.out, done.err, done.requests
        return done.out.splitlines()


class Plans(Case):
    def test_a_straight_line_within_the_joints_speeds(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
group.set_joint_value_target([1.0, -0.5])
success, plan, seconds, code = group.plan()
points = plan.joint_trajectory.points
print(success, seconds, code.val, plan.joint_trajectory.joint_names, plan.joint_trajectory.header.frame_id, len(points))
for point in points:
    print("%.3f" % point.time_from_start.to_sec(), near(point.positions), near(point.velocities), near(point.accelerations))
group.set_max_velocity_scaling_factor(0.1)
group.set_max_acceleration_scaling_factor(0.5)
print("%.3f" % group.plan([1.0, -0.5])[1].joint_trajectory.points[-1].time_from_start.to_sec())
print(len(group.plan([0, 0])[1].joint_trajectory.points), type(points[0].positions).__name__)
"""
        self.assertEqual(
            self.said(text),
            [
                "True 0.0 1 ['shoulder', 'elbow'] base 3",
                "0.000 [0.0, 0.0] [0.0, 0.0] [1.0, -0.5]",
                "1.000 [0.5, -0.25] [1.0, -0.5] [0.0, 0.0]",
                "2.000 [1.0, -0.5] [0.0, 0.0] [0.0, 0.0]",
                "10.200",
                "1 tuple",
            ],
        )

    def test_what_melodic_returns(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
group.set_named_target("up")
plan = group.plan()
print(near(plan.joint_trajectory.points[-1].positions), group.execute(plan), group.get_current_joint_values())
group.set_position_target([2, 0, 0])
print(len(group.plan().joint_trajectory.points))
"""
        self.assertEqual(self.said(text, moveit="melodic"), ["[1.0, -0.5] True [1.0, -0.5]", "0"])
        self.assertIn("group arm cannot reach its target: the place is out of reach", self.out + self.err)

    def test_targets_by_place(self):
        text = """
from geometry_msgs.msg import Pose, PoseStamped
group = moveit_commander.MoveGroupCommander("arm")
group.set_position_target([0.5, 0.25, 1.0])
print(near(group.plan()[1].joint_trajectory.points[-1].positions))
pose = PoseStamped()
pose.header.frame_id = "base"
pose.pose.position.x, pose.pose.orientation.w = 0.75, 1.0
group.set_pose_target(pose)
print(near(group.plan()[1].joint_trajectory.points[-1].positions))
print(near(group.plan(pose.pose)[1].joint_trajectory.points[-1].positions))
group.set_pose_target([2, 0, 0, 0, 0, 0])
success, plan, _, code = group.plan()
print(success, len(plan.joint_trajectory.points), code.val, group.go())
group.clear_pose_targets()
print(group.plan()[0])
group.set_joint_value_target(pose)
print(group.get_joint_value_target())
pose.header.frame_id = "moon"
tries(lambda: group.set_pose_target(pose), lambda: group.set_pose_target([1, 2]), lambda: group.set_pose_target([0] * 6, "foot"))
"""
        out = self.said(text)
        self.assertEqual(
            [line for line in out if "WARN" not in line],
            [
                "[0.5, 0.25]",
                "[0.75, 0.0]",
                "[0.75, 0.0]",
                "False 0 -31 False",
                "True",
                "[0.75, 0.0]",
                "MoveItCommanderException group arm plans in the frame base, not in moon: bring the pose there first, by tf",
                "MoveItCommanderException Expected either 6 or 7 elements in list: (x,y,z,r,p,y) or (x,y,z,qx,qy,qz,qw)",
                "MoveItCommanderException group arm has no end-effector foot, but hand",
            ],
        )
        asked = [request for request in self.requests if request["request"] == "plan"]
        self.assertEqual(
            asked[0],
            {
                "request": "plan", "device": "robot.arm", "to": [0.5, 0.25, 1.0], "timed": True,
                "speeds": [1.0, 0.5], "accelerations": [1.0, 1.0],
            },
        )  # fmt: skip
        self.assertEqual(asked[1]["orientation"], [0.0, 0.0, 0.0, 1.0])
        self.assertEqual((self.out + self.err).count("and not for its orientation"), 1)

    def test_a_start_elsewhere_and_factors_are_asked_for(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
state = group.get_current_state()
state.joint_state.position = [0.5, 0.0]
group.set_start_state(state)
group.set_max_velocity_scaling_factor(0.5)
group.set_max_acceleration_scaling_factor(0.25)
points = group.plan([1.0, 0.0])[1].joint_trajectory.points
print(near(points[0].positions), "%.3f" % points[-1].time_from_start.to_sec())
state.joint_state.position = [0.005, 0.0]
group.set_start_state(state)
print(near(group.plan([1.0, 0.0])[1].joint_trajectory.points[0].positions))
"""
        self.assertEqual(self.said(text), ["[0.5, 0.0] 3.000", "[0.005, 0.0]"])
        first, second = [request for request in self.requests if request["request"] == "plan"]
        self.assertEqual((first["from"], first["speeds"]), ([0.5, 0.0], [0.5, 0.25]))
        self.assertEqual(first["accelerations"], [0.25, 0.25])
        self.assertNotIn("from", second, "the arm is there, nearly")

    def test_a_path_of_the_hand(self):
        text = """
from moveit_commander.conversions import list_to_pose
group = moveit_commander.MoveGroupCommander("arm")
path, fraction = group.compute_cartesian_path([list_to_pose([0.9, 0, 0.25, 0, 0, 0, 1])], 0.1, 0.0)
print(fraction, [near(point.positions) for point in path.joint_trajectory.points])
path, fraction = group.compute_cartesian_path([list_to_pose([1.5, 0, 0.25, 0, 0, 0, 1])], 0.1, True)
print(fraction)
timed = group.retime_trajectory(group.get_current_state(), path, 0.5, 0.5)
for made in (path, timed):
    print(["%.4f" % point.time_from_start.to_sec() for point in made.joint_trajectory.points])
    print(made.joint_trajectory.points[1].velocities)
"""
        self.assertEqual(
            self.said(text),
            [
                "1.0 [[0.0, 0.0], [0.6, 0.0], [0.7, 0.0], [0.8, 0.0], [0.9, 0.0]]",
                "0.5",
                "['0.0000', '1.1010', '1.2081', '1.3300', '1.4877', '2.0000']",
                "(0.9714697864743692, 0.0)",
                "['0.0000', '1.7000', '1.9000', '2.1010', '2.3300', '3.0000']",
                "(0.5, 0.0)",
            ],
        )


    def test_what_the_tutorial_of_moveit_does(self):
        text = """
from math import dist, fabs, cos, pi
import geometry_msgs.msg, moveit_msgs.msg
from moveit_commander.conversions import pose_to_list

def all_close(goal, actual, tolerance):
    if type(goal) is list:
        return all(abs(goal[index] - actual[index]) <= tolerance for index in range(len(goal)))
    if type(goal) is geometry_msgs.msg.PoseStamped:
        return all_close(goal.pose, actual.pose, tolerance)
    x0, y0, z0, qx0, qy0, qz0, qw0 = pose_to_list(actual)
    x1, y1, z1, qx1, qy1, qz1, qw1 = pose_to_list(goal)
    d = dist((x1, y1, z1), (x0, y0, z0))
    return d <= tolerance and fabs(qx0 * qx1 + qy0 * qy1 + qz0 * qz1 + qw0 * qw1) >= cos(tolerance / 2.0)

robot = moveit_commander.RobotCommander()
scene = moveit_commander.PlanningSceneInterface()
group = moveit_commander.MoveGroupCommander("arm")
display = rospy.Publisher("/move_group/display_planned_path", moveit_msgs.msg.DisplayTrajectory, queue_size=20)
print(group.get_planning_frame(), group.get_end_effector_link(), robot.get_group_names())
joint_goal = group.get_current_joint_values()
joint_goal[0], joint_goal[1] = pi / 4, 0
group.go(joint_goal, wait=True)
group.stop()
print(all_close(joint_goal, group.get_current_joint_values(), 0.01))
here = group.get_current_pose().pose
print(near(pose_to_list(here)), all_close(here, group.get_current_pose().pose, 0.01))
here.position.x += 0.1
print(all_close(here, group.get_current_pose().pose, 0.01))
group.set_pose_target(here)
print(group.go(wait=True))
group.clear_pose_targets()
plan, fraction = group.compute_cartesian_path([here], 0.05, 0.0)
shown = moveit_msgs.msg.DisplayTrajectory()
shown.trajectory_start = robot.get_current_state()
shown.trajectory.append(plan)
display.publish(shown)
print(group.execute(plan, wait=True), len(shown.trajectory[0].joint_trajectory.points) > 2)
box = geometry_msgs.msg.PoseStamped()
box.header.frame_id = "hand"
box.pose.orientation.w = 1.0
scene.add_box("box", box, size=(0.075, 0.075, 0.075))
scene.attach_box("hand", "box", touch_links=robot.get_link_names(group="arm"))
print(len(scene.get_attached_objects(["box"]).keys()) > 0, "box" in scene.get_known_object_names())
scene.remove_attached_object("hand", name="box")
scene.remove_world_object("box")
print(len(scene.get_attached_objects(["box"]).keys()) > 0, "box" in scene.get_known_object_names())
"""
        system = Arm()
        out = [line for line in self.said(text, system) if "WARN" not in line and "INFO" not in line]
        quaternion = [0.0, 0.0, 0.479426, 0.877583]
        expected = ["base hand ['arm']", "True", str([0.5, 0.0, 0.25, *quaternion]) + " True", "False", "True"]
        self.assertEqual(out, [*expected, "True True", "True False", "False False"])
        ((_, topic, message),) = system.published
        self.assertEqual(topic, "/move_group/display_planned_path")
        self.assertEqual(message["trajectory"][0]["joint_trajectory"]["joint_names"], ["shoulder", "elbow"])
        self.assertEqual(message["trajectory_start"]["joint_state"]["name"], ["shoulder", "elbow"])

    def test_targets_that_are_shifted_and_several(self):
        text = """
from geometry_msgs.msg import Pose
group = moveit_commander.MoveGroupCommander("arm")
group.shift_pose_target(0, 0.25)
print(near(group.plan()[1].joint_trajectory.points[-1].positions))
group.shift_pose_target(1, -0.125, "hand")
print(near(group.plan()[1].joint_trajectory.points[-1].positions))
group.shift_pose_target(5, 0.5)
print(group.plan()[0])
tries(lambda: group.shift_pose_target(6, 1.0), lambda: group.shift_pose_target(0, 1.0, "foot"))
first, second = Pose(), Pose()
first.position.x, second.position.x = 0.75, 0.25
first.orientation.w = second.orientation.w = 1.0
group.set_pose_targets([first, second])
print(near(group.plan()[1].joint_trajectory.points[-1].positions))
tries(lambda: group.set_pose_targets([]))
"""
        out = [line for line in self.said(text) if "WARN" not in line]
        self.assertEqual(
            out,
            [
                "[0.75, 0.0]",
                "[0.5, -0.125]",
                "True",
                "MoveItCommanderException An axis value between 0 and 5 expected",
                "MoveItCommanderException group arm has no end-effector foot, but hand",
                "[0.75, 0.0]",
                "MoveItCommanderException Unable to set target poses",
            ],
        )
        asked = [request for request in self.requests if request["request"] == "plan"]
        turned = asked[2]["orientation"]  # by half a radian more than the hand has
        self.assertAlmostEqual(turned[2], 0.6816387600233341)
        self.assertAlmostEqual(turned[3], 0.7316888688738209)


class Motions(Case):
    def test_it_returns_at_the_end(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
say(group.go([1.0, 0.0]), group.get_current_joint_values())
say(group.go({"elbow": 1.0}, wait=True))
plan = group.plan([0, 0])
rospy.sleep(1)
say(group.execute(plan[1], wait=True), group.execute(plan[1]))
group.set_joint_value_target([-2.0, 0.0])
say(group.go(wait=True))
tries(lambda: group.execute(plan))
"""
        system = Arm()
        out = self.said(text, system)
        self.assertEqual(
            [line for line in out if "INFO" not in line and "ERROR" not in line and line],
            [
                "2.000 True [1.0, 0.0]",
                "4.500 True",
                "8.000 True False",
                "9.500 False",
                "MoveItCommanderException execute takes a trajectory, and not a tuple: plan() returns (success, trajectory,"
                " planning time, error code)",
            ],
        )
        said = self.out + self.err
        self.assertIn("Invalid Trajectory: start point deviates from current robot state more than 0.01", said)
        self.assertIn("ABORTED: it hit something", said)
        time, args = system.followed[0]
        self.assertEqual((time, args["times"][:2], args["positions"][:2]), (0, [0.0, 1.0], [0.0, 0.0]))
        self.assertEqual((args["times"][-1], args["positions"][-2:]), (2.0, [1.0, 0.0]))

    def test_one_that_is_stopped(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
group.stop()  # nothing moves
say(group.go([1.0, 0.0], wait=False))
rospy.sleep(0.5)
group.stop()
group.stop()
rospy.sleep(1)
say(group.get_current_joint_values())
"""
        system = Arm()
        self.assertEqual(self.said(text, system), ["0.000 True", "1.500 [0.0, 0.0]"])
        self.assertEqual(system.followed[1][1], {"positions": [0.0, 0.0], "times": [0.0]})


class Robots(Case):
    def test_names_and_states(self):
        text = """
robot = moveit_commander.RobotCommander()
print(robot.get_group_names(), robot.get_joint_names(), robot.get_joint_names("arm"), robot.get_link_names(), robot.get_planning_frame())
print(robot.arm is robot.get_group("arm"), robot.shoulder.bounds(), robot.elbow.value(), robot.get_current_variable_values())
state = robot.get_current_state()
print(state.joint_state.name, near(state.joint_state.position))
group = robot.get_group("arm")
print(group.get_name(), group.get_active_joints() == group.get_joints()[:2], group.get_active_joints(), group.get_end_effector_link(), group.get_planning_frame(), group.get_variable_count())
pose = group.get_current_pose()
print(pose.header.frame_id, near((pose.pose.position.x, pose.pose.position.z)), near(group.get_current_rpy()))
print(robot.shoulder.move(0.5), group.get_current_joint_values())
tries(lambda: robot.get_group("leg"), lambda: robot.get_joint("knee"), lambda: moveit_commander.MoveGroupCommander("leg"))
try:
    robot.leg
except AttributeError as error:
    print(error)
moveit_commander.roscpp_shutdown()
"""
        self.assertEqual(
            self.said(text),
            [
                "['arm'] ['shoulder', 'elbow'] ['shoulder', 'elbow'] ['base', 'link', 'hand'] base",
                "True [-2.0, 2.0] 0.0 {'shoulder': 0.0, 'elbow': 0.0}",
                "['shoulder', 'elbow'] [0.0, 0.0]",
                "arm True ['shoulder', 'elbow'] hand base 2",
                "base [0.5, 0.25] [0.0, 0.0, 1.0]",
                "True [0.5, 0.0]",
                "MoveItCommanderException There is no group named leg",
                "MoveItCommanderException There is no joint named knee",
                "RuntimeError Group 'leg' was not found. (The scenario's binding has: arm.)",
                "'RobotCommander' object has no attribute 'leg'",
            ],
        )

    def test_joints_without_bounds(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
print(group.go([30.0, -30.0]), near(group.get_current_joint_values()), all(abs(v) < 4 for v in group.get_random_joint_values()))
"""
        joints = [{"name": "a", "lower": None, "upper": None}, {"name": "b"}]
        self.assertEqual(self.said(text, groups={"arm": {"device": "robot.arm", "joints": joints}}), ["True [30.0, -30.0] True"])

    def test_a_pose_that_is_not_known(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
tries(lambda: group.get_current_pose())
"""
        out = self.said(text, Arm(tool=False))
        self.assertIn("the pose of the end-effector of group arm is not known: device robot.arm does not tell it", out[0])


class Targets(Case):
    def test_joint_targets(self):
        text = """
from sensor_msgs.msg import JointState
group = moveit_commander.MoveGroupCommander("arm")
group.set_joint_value_target({"elbow": 0.5})
group.set_joint_value_target("shoulder", 0.25)
print(group.get_joint_value_target())
group.set_joint_value_target(JointState(name=["elbow", "camera"], position=[-0.5, 1]))
print(group.get_joint_value_target())
tries(
    lambda: group.set_joint_value_target([0.0, 1.6]),
    lambda: group.set_joint_value_target([0.0]),
    lambda: group.set_joint_value_target("knee", 1.0),
    lambda: group.set_joint_value_target("elbow"),
    lambda: group.set_joint_value_target(7),
    lambda: group.set_named_target("down"),
    lambda: group.set_max_velocity_scaling_factor(1.5),
    lambda: group.set_rpy_target([0, 0, 0]),
    lambda: group.get_jacobian_matrix([0, 0]),
    lambda: group.pick("cup"),
)
group.remember_joint_values("here", [0.1, 0.2])
group.set_named_target("here")
print(group.get_named_targets(), group.get_named_target_values("up"), group.get_joint_value_target())
print(group.get_goal_tolerance(), group.get_planning_time(), all(abs(value) <= 2 for value in group.get_random_joint_values()))
"""
        out = [line for line in self.said(text) if "ERROR" not in line]
        bounds = "MoveItCommanderException Error setting joint target. Is the target within bounds?"
        self.assertEqual(
            out,
            [
                "[0.25, 0.5]",
                "[0.25, -0.5]",
                bounds,
                bounds,
                bounds,
                "MoveItCommanderException Joint value expected when joint name specified",
                "MoveItCommanderException Unsupported argument of type <class 'int'>",
                "MoveItCommanderException Unable to set target down. Is the target within bounds? (Known targets: home, up.)",
                "MoveItCommanderException Expected value in the range from 0 to 1 for scaling factor",
                "NotImplementedError MoveGroupCommander.set_rpy_target is not there in hrdsl: set the angles of the joints"
                " (set_joint_value_target)",
                "NotImplementedError MoveGroupCommander.get_jacobian_matrix is not there in hrdsl: a plan is the way"
                " that hrdsl's own planner finds",
                "NotImplementedError MoveGroupCommander.pick is not there in hrdsl: move the group there, close the gripper and"
                " attach the object",
                "['home', 'up', 'here'] {'shoulder': 1.0, 'elbow': -0.5} [0.1, 0.2]",
                "(0.0001, 0.0001, 0.001) 5.0 True",
            ],
        )
        for why in ("elbow cannot be 1.6, but -1.5 to 1.5", "it has 2 joints, and 1 values", "it has no joint knee"):
            self.assertIn("target of group arm: " + why, self.out + self.err)

    def test_tolerances_and_the_planner_are_kept(self):
        text = """
group = moveit_commander.MoveGroupCommander("arm")
group.set_planner_id("RRTConnectkConfigDefault")
group.set_planner_id("RRTConnectkConfigDefault")
group.set_goal_tolerance(0.25)
group.set_goal_position_tolerance(0.25)
print(repr(group.get_planner_id()), group.get_goal_tolerance(), group.get_goal_joint_tolerance())
group.set_joint_value_target([0.0, 1.625])  # as far beyond its bounds as the tolerance allows
group.set_goal_joint_tolerance(0.01)
tries(lambda: group.set_joint_value_target([0.0, 1.625]))
"""
        out = [line for line in self.said(text) if "ERROR" not in line]
        bounds = "MoveItCommanderException Error setting joint target. Is the target within bounds?"
        self.assertEqual(out, ["'RRTConnectkConfigDefault' (0.25, 0.25, 0.25) 0.25", bounds])
        for warning in ("identifiers of planners and pipelines are kept, and change no plan", "tolerances of positions and orientations are kept, and"):
            self.assertEqual((self.out + self.err).count(warning), 1, self.err)

    def test_a_group_attaches_and_detaches(self):
        text = """
scene = moveit_commander.PlanningSceneInterface()
group = moveit_commander.MoveGroupCommander("arm")
print(group.attach_object("cup"), group.attach_object("tray", "link", ["base"]))
print({name: of.link_name for name, of in scene.get_attached_objects().items()}, scene.get_known_object_names())
print(group.detach_object("cup"), list(scene.get_attached_objects()), scene.get_known_object_names())
print(group.detach_object("cup"), group.detach_object("link"), group.detach_object(), list(scene.get_attached_objects()))
"""
        out = [line for line in self.said(text) if "WARN" not in line]
        self.assertEqual(
            out,
            ["True True", "{'cup': 'hand', 'tray': 'link'} []", "True ['tray'] ['cup']", "False True False []"],
        )

    def test_the_scene_is_kept(self):
        text = """
from geometry_msgs.msg import PoseStamped
scene = moveit_commander.PlanningSceneInterface()
pose = PoseStamped()
pose.header.frame_id = "base"
pose.pose.position.x = 1.0
scene.add_box("table", pose, size=(1, 2, 0.1))
scene.add_sphere("ball", pose, 0.1)
print(scene.get_known_object_names(), list(scene.get_objects(["table"])["table"].primitives[0].dimensions))
scene.attach_box("hand", "ball", touch_links=["finger"])
print(scene.get_known_object_names(), list(scene.get_attached_objects()), scene.get_attached_objects()["ball"].link_name)
print(scene.get_object_poses(["table"])["table"].position.x)
scene.remove_attached_object("hand", "ball")
scene.remove_world_object("table")
print(moveit_commander.PlanningSceneInterface().get_known_object_names(), scene.get_attached_objects())
scene.remove_world_object()
print(scene.get_known_object_names())
tries(lambda: scene.add_mesh("cup", pose, "cup.stl"), lambda: scene.apply_planning_scene(None))
"""
        out = [line for line in self.said(text) if "WARN" not in line]
        self.assertEqual(
            out,
            [
                "['table', 'ball'] [1.0, 2.0, 0.1]",
                "['table'] ['ball'] hand",
                "1.0",
                "['ball'] {}",
                "[]",
                "MoveItCommanderException meshes are not read in hrdsl (cup.stl): add a box of the same size (add_box), since no"
                " plan avoids objects anyway",
                "NotImplementedError PlanningSceneInterface.apply_planning_scene is not there in hrdsl: add and remove objects"
                " one by one",
            ],
        )
        self.assertEqual((self.out + self.err).count("plans avoid what is in the scenario's world"), 1)


if __name__ == "__main__":
    unittest.main()
