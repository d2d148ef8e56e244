"""Makes every kind of request and prints what it gets."""

import sys

import hrdsl

node = hrdsl.Node("good")
print("seed", node.seed, "args", sys.argv[1:])
print("now", node.now())
node.sleep(1.5)
node.emit("decided", ready=True, n=3, x=0.5, pace="fast")
print("first", node.wait_for("a", "b", timeout=2.0))
print("second", node.wait_for("a"))
event = node.wait_for("sensed")
print("third", event.name, event.gaze, event.args, event.time)
node.drop("a")
print("read", node.read("pressure"), node.read("height"), node.read("pace"))
arm = node.arm("robot.arm")
print("move", arm.move_to((0.1, 2, -0.3), speed=0.2), arm.move_joints([0, 1.5]), arm.last_error)
grip = node.gripper("robot.grip")
print("grip", grip.close(), grip.open())
