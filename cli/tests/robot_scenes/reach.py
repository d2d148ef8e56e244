"""Brings the left hand to the place that it is shown, and says how well the arm followed."""

import sys

import hrdsl

PLACES = {"behind": (0.37, 0.12, 0.98), "inside": (0.30, 0.32, 0.98)}
POSTURE = (-1.56, 1.33, -1.42, -1.36, 2.39, -0.2, 0.68)  # rad, in which the hand is behind the post
ASIDE = (0.0, 0.3, 0.1, 0.1, 0.3, 0.2, 0.2)  # rad, away from the post
JOINTS = 7
TIME = 3.0  # seconds for the straight way


class Guest:
    def __init__(self, node):
        self.node = node
        self.arm = node.arm("robot.left")

    def joints(self):
        return [self.node.read("q%d" % (i + 1)) for i in range(JOINTS)]

    def reach(self, place):
        if not self.arm.move_to(PLACES[place], speed=0.5):
            print("failed:", self.arm.last_error)

    def straight(self, goal):
        """Goes to a posture at an even speed, and tells how far the joints are from where they are to be."""
        start = self.joints()
        began = self.node.now()
        motion = self.arm.begin("follow", positions=list(goal), times=[TIME])
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
    node = hrdsl.Node("reach")
    guest = Guest(node)
    shown = node.wait_for("shown", timeout=5.0)
    if shown is None:
        return
    if "straight" in sys.argv:
        guest.straight(POSTURE)
    else:
        guest.straight([q + by for q, by in zip(guest.joints(), ASIDE)])
        guest.reach(shown.place)


if __name__ == "__main__":
    main()
