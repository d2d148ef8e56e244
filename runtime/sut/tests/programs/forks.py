"""Leaves a child behind that holds all pipes open."""

import os
import posix
import time

import hrdsl

node = hrdsl.Node("forks")
really_sleep = __import__("signal").pause
child = posix.fork()
if child == 0:
    really_sleep()
node.emit("child", pid=child)
os._exit(7)
