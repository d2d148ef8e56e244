"""Takes the box that is ordered from one table to the other, and says how well the arm followed."""

import sys

import hrdsl

PLACES = {"light": (0.40, 0.35, 0.275), "heavy": (0.60, 0.35, 0.275)}
GOAL = (0.50, -0.30, 0.277)
JOINTS = 7
STRETCH = (0.3, 0.2, -0.3, 0.3, 0.3, -0.3, 0.3)  # rad from where the arm is
TIME = 2.0  # seconds for this


def above(place, by=0.2):
    return (place[0], place[1], place[2] + by)


class Porter:
    def __init__(self, node, careless):
        self.node = node
        self.arm, self.grip = node.arm("robot.arm"), node.gripper("robot.grip")
        self.careless = careless

    def carry(self, load):
        place = PLACES[load]
        steps = [
            self.grip.open,
            lambda: self.arm.move_to(above(place)),
            lambda: self.arm.move_to(place, speed=0.3),
            self.grip.close,
            lambda: self.arm.move_to(above(place), speed=0.5),
            lambda: self.arm.move_to(above(GOAL), speed=0.7),
        ]
        if self.careless:
            steps += [
                lambda: self.arm.move_to(above((GOAL[0], GOAL[1] - 0.1, GOAL[2]))),
                self.grip.open,
                lambda: self.arm.move_to((GOAL[0], GOAL[1] + 0.1, 0.225), speed=0.3),
            ]
        else:
            steps += [
                lambda: self.arm.move_to(GOAL, speed=0.3),
                self.grip.open,
                lambda: self.arm.move_to(above(GOAL), speed=0.3),
            ]
        for number, step in enumerate(steps):
            if not step():
                print("step %d failed: %s" % (number, self.arm.last_error or self.grip.last_error))
                return

    def joints(self):
        return [self.node.read("q%d" % (i + 1)) for i in range(JOINTS)]

    def follow(self):
        """Goes to a posture at an even speed, and tells how far the joints are from where they are to be."""
        start = self.joints()
        goal = [q + by for q, by in zip(start, STRETCH)]
        began = self.node.now()
        motion = self.arm.begin("follow", positions=goal, times=[TIME])
        lag = 0.0
        while not motion.done():
            part = min((self.node.now() - began) / TIME, 1.0)
            wanted = [a + part * (b - a) for a, b in zip(start, goal)]
            lag = max([lag] + [abs(q - w) for q, w in zip(self.joints(), wanted)])
            self.node.sleep(0.02)
        left = max(abs(q - w) for q, w in zip(self.joints(), goal))
        if motion.error is not None:
            print("follow failed:", motion.error)
        print("tracking error: on the way %.4f rad, at the end %.5f rad" % (lag, left))


def main():
    node = hrdsl.Node("arm")
    porter = Porter(node, "careless" in sys.argv)
    order = node.wait_for("ordered", timeout=5.0)
    if order is not None:
        porter.carry(order.load)
        node.sleep(1.0)
        porter.follow()


if __name__ == "__main__":
    main()
