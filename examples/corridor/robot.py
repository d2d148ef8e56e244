#!/usr/bin/env python3
"""Crosses a corridor piece by piece, and asks whoever is in the way to step aside."""

import hrdsl

PIECES = 4  # of the way
PIECE = 1.0  # seconds for each
SPEED = 0.2  # m/s
ASKS = 2
PATIENCE = 4.0  # seconds after asking
CLOSING_TIME = 40.0  # seconds without a trip


class Porter:
    """A small state machine: each state is a method that returns the next one."""

    def __init__(self, node):
        self.node = node
        self.wheels = node.device("robot.wheels")

    def run(self):
        state = self.home
        while state is not None:
            state = state()

    def home(self):
        if self.node.wait_for("sent", timeout=CLOSING_TIME) is None:
            return None
        self.asks = self.pieces = 0
        return self.looking

    def looking(self):
        if self.node.read("someone"):
            return self.asking if self.asks < ASKS else self.giving_up
        return self.driving if self.pieces < PIECES else self.arriving

    def driving(self):
        self.node.emit("moving")
        end = self.node.now() + PIECE
        while self.node.now() < end:
            if self.node.read("someone"):
                return self.braking
            self.wheels.command("drive", forward=SPEED, turn=0.0)  # the base stops by itself if it hears nothing
            self.node.sleep(0.1)
        self.wheels.command("stop")
        self.pieces += 1
        return self.looking

    def braking(self):
        self.wheels.command("stop")
        self.node.sleep(1.0)  # who runs across is gone then
        return self.looking

    def asking(self):
        self.asks += 1
        self.node.drop("cleared")
        self.node.emit("excuse_me")
        self.node.wait_for("cleared", timeout=PATIENCE)
        return self.looking

    def arriving(self):
        self.node.emit("passed")
        return self.home

    def giving_up(self):
        self.node.emit("gave_up")
        return self.home


if __name__ == "__main__":
    Porter(hrdsl.Node("robot")).run()
