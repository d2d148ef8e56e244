"""Takes the box from its place on the table, and puts it on the goal."""

import sys

import hrdsl

ABOVE = (0.0, 0.0, 0.12)
BEFORE = (-0.14, 0.0, 0.0)
BOX = (0.55, 0.10, 0.66)
GOAL = (0.55, -0.15, 0.662)


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b))


def main():
    node = hrdsl.Node("pick")
    arm, grip = node.arm("robot.arm"), node.gripper("robot.grip")
    node.sleep(0.5)
    steps = [
        ("open", grip.open),
        ("approach", lambda: arm.move_to(plus(BOX, BEFORE))),
        ("reach", lambda: arm.move_to(BOX, speed=0.3)),
        ("close", grip.close),
        ("lift", lambda: arm.move_to(plus(BOX, ABOVE), speed=0.3)),
        ("carry", lambda: arm.move_to(plus(GOAL, ABOVE), speed=0.5)),
        ("lower", lambda: arm.move_to(GOAL, speed=0.3)),
        ("release", grip.open),
        ("retreat", lambda: arm.move_to(plus(GOAL, BEFORE), speed=0.3)),
    ]
    for name, step in steps:
        if not step():
            print(name, "failed:", arm.last_error or grip.last_error, file=sys.stderr)
            node.emit("failed")
            return 1
        if name == "lower":
            node.emit("placed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
