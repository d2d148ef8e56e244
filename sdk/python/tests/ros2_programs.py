"""Runs programs of ROS 2 over a harness that a test writes."""

import json
import os
import tempfile
import textwrap
import unittest

import ros2_table
from harness import run
from system import System

SECOND = 10**9

#: The beginning of programs that try calls, and print what they give or raise.
TRIED = """
import rclpy, sys
from rclpy.node import Node
from rcl_interfaces.msg import *
from rclpy.parameter import Parameter

def tried(call):
    try:
        print(call())
    except Exception as error:
        print("%s: %s" % (type(error).__name__, error))

"""

_binding = None


def binding(**more):
    """A binding file with the standard packages."""
    global _binding
    if _binding is None or more:
        file = tempfile.NamedTemporaryFile("w", suffix=".json", delete=False)
        with file:
            json.dump({"ros": 2, "interfaces": ros2_table.table(), **more}, file)
        if more:
            return file.name
        _binding = file.name
    return _binding


def run_ros2(text, system=None, args=(), env=None, **more):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "program.py")
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))
        given = {"HRDSL_MIDDLEWARE": "ros2", "HRDSL_BINDING": binding(**more), **(env or {})}
        return run([path, *args], system=system or System(end=100 * SECOND), env=given)


class Ros2Case(unittest.TestCase):
    maxDiff = None

    def said(self, text, system=None, err="", **how):
        """What a program prints that ends by itself, or with the test."""
        finished = run_ros2(text, system=system, **how)
        self.assertEqual((finished.code, finished.err), (0, err))
        self.finished = finished
        return finished.out.splitlines()

    def failed(self, text, **how):
        finished = run_ros2(text, **how)
        self.assertEqual(finished.code, 1, finished.out + finished.err)
        return finished.err


