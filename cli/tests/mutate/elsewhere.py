"""Gives light without the file that is said to do so."""

import hrdsl

node = hrdsl.Node("robot")
while node.wait_for("asked", timeout=10.0) is not None:
    node.emit("lit")
