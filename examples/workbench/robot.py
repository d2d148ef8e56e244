#!/usr/bin/env python3
"""Lifts what it is told to, and opens its hand when it is told to let go."""

import hrdsl

PLACES = {"box": (0.30, -0.30, 0.5555), "block": (0.30, -0.46, 0.5555)}  # metres
HEIGHT = 0.15
SPEED = 0.4  # rad/s


def above(place):
    """Where the hand goes before it grasps, and after."""
    x, y, z = place
    return (x, y, z + HEIGHT)


def lift(arm, gripper, place):
    """Takes what stands at a place, and holds it up; whether everything went well."""
    steps = (
        gripper.open,
        lambda: arm.move_to(above(place), speed=SPEED),
        lambda: arm.move_to(place, speed=SPEED),
        gripper.close,
        lambda: arm.move_to(above(place), speed=SPEED),
    )
    return all(step() for step in steps)


def main():
    node = hrdsl.Node("robot")
    arm, gripper = node.arm("robot.arm"), node.gripper("robot.grip")
    while True:
        event = node.wait_for("lift", "let_go", timeout=30.0)
        if event is None:
            return
        if event.name == "let_go":
            gripper.open()
        elif not lift(arm, gripper, PLACES[event.args["load"]]):
            print("the lift failed: %s" % (arm.last_error or gripper.last_error))


if __name__ == "__main__":
    main()
