"""Leaves a child behind that holds all pipes open."""

import os
import time

import hrdsl

node = hrdsl.Node("forks")
really_sleep = __import__("signal").pause
child = os.fork()
if child == 0:
    really_sleep()
node.emit("child", pid=child)
os._exit(7)
