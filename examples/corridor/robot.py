#!/usr/bin/env python3
"""Crosses a corridor piece by piece, and asks whoever is in the way to step aside.

The base of this robot is not simulated: `moving` says that it would drive the next piece now.
"""

import hrdsl

PIECES = 4  # of the way
PIECE = 1.0  # seconds for each
ASKS = 2
PATIENCE = 4.0  # seconds after asking
CLOSING_TIME = 40.0  # seconds without a trip


class Porter:
    """A small state machine: each state is a method that returns the next one."""

    def __init__(self, node):
        self.node = node

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
        self.pieces += 1
        self.node.emit("moving")
        self.node.sleep(PIECE)
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
