#!/usr/bin/env python3
"""Answers whoever asks a question, if they are still there.

This is the code under test. The `hrdsl` package connects it to the simulation: its calls are answered in simulated time. On
a real robot the same calls would go to microphones, speakers and cameras.
"""

import hrdsl

THINKING = 1.5  # seconds
CLOSING_TIME = 60.0  # seconds without a question; a test lasts until the robot goes home


class Greeter:
    """One conversation after the other."""

    def __init__(self, node):
        self.node = node
        self.answered = 0

    def run(self):
        """Until nobody asks any more."""
        while True:
            question = self.node.wait_for("question", timeout=CLOSING_TIME)
            if question is None:
                break
            self.reply(question)
        print("answered %d questions" % self.answered)

    def reply(self, question):
        self.node.drop("left")  # steps heard before the question
        steps = self.node.wait_for("left", timeout=THINKING)
        if steps is not None or not self.node.read("near"):
            self.node.emit("gave_up")
            return
        self.answered += 1
        self.node.emit("answer", politely=question.politely)


if __name__ == "__main__":
    Greeter(hrdsl.Node("robot")).run()
