"""Writes 100 MB to its output while it works."""

import sys

import hrdsl

node = hrdsl.Node("floods")
sys.stdout.write("the beginning\n")
for n in range(100):
    sys.stdout.write(("x" * 999 + "\n") * 1000)
    if n % 10 == 0:
        node.now()
sys.stdout.write("the end\n")
sys.stdout.flush()
node.emit("finished")
